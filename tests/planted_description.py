"""Faults of the description: variables, units, structure, capabilities."""

from planted import DESCRIPTION, Edit, Fault, told

VARIABLES = (
    told(
        "the GUID is another FMU's",
        ' guid="{',
        ' guid="{0',
        "instantiation",
        "begin",
    ),
    told(
        "a unit is not defined",
        '    <Unit name="N">\n      <BaseUnit kg="1" m="1" s="-2" />\n    </Unit>\n',
        "",
        "unit-undefined",
        "description",
    ),
    told(
        "newton has wrong exponents",
        '<BaseUnit kg="1" m="1" s="-2" />',
        '<BaseUnit kg="1" m="1" s="-1" />',
        "unit-definition",
        "description",
    ),
    told(
        "hertz has wrong exponents",
        '<Unit name="Hz">\n      <BaseUnit s="-1" />',
        '<Unit name="Hz">\n      <BaseUnit s="1" />',
        "unit-definition",
        "description",
    ),
    told(
        "a start value is not the FMU's",
        '<Real unit="1/s" start="0.3"',
        '<Real unit="1/s" start="0.31"',
        "start-values",
        "values",
    ),
    told(
        "a start value is out of its range",
        'start="6" min="0" max="6"',
        'start="6" min="0" max="5"',
        "range",
        "description",
    ),
    told(
        "a range is empty",
        'start="6" min="0" max="6"',
        'start="6" min="7" max="6"',
        "range",
        "description",
    ),
    told(
        "a nominal is 0",
        'nominal="0.0001493571719205647"',
        'nominal="0.0"',
        "range",
        "description",
    ),
    told(
        "an input has no start value",
        'description="force in z at left" causality="input" variability="continuous">\n'
        '      <Real unit="N" start="0.0" />',
        'description="force in z at left" causality="input" variability="continuous">\n'
        '      <Real unit="N" />',
        "model-description",
        "description",
    ),
    told(
        "an output has a start value though it is calculated",
        '<Real unit="m/s" />',
        '<Real unit="m/s" start="0.0" />',
        "model-description",
        "description",
    ),
    told(
        "a parameter varies continuously",
        'causality="parameter" variability="tunable" initial="exact">\n      <Real unit="s"',
        'causality="parameter" variability="continuous" initial="exact">\n      <Real unit="s"',
        "model-description",
        "description",
    ),
    told(
        "an input is calculated",
        'at right" causality="input" variability="continuous">',
        'at right" causality="input" variability="continuous" initial="calculated">',
        "model-description",
        "description",
    ),
    told(
        "two variables have one name",
        'name="left.velocity.z"',
        'name="left.displacement.x"',
        "model-description",
        "description",
    ),
    told(
        "two outputs have one value reference",
        'valueReference="4"',
        'valueReference="3"',
        "alias",
        "description",
    ),
    told(
        "a variable has a value reference that is not there",
        'name="right.displacement.y" valueReference="7"',
        'name="right.displacement.y" valueReference="700"',
        "first-step",
        "begin",
    ),
    Fault(
        "two outputs have each other's name",
        (
            Edit(DESCRIPTION, 'name="left.acceleration.z"', 'name="@"'),
            Edit(DESCRIPTION, 'name="right.acceleration.y"', 'name="left.acceleration.z"'),
            Edit(DESCRIPTION, 'name="@"', 'name="right.acceleration.y"'),
        ),
        "reference-results",
        "references",
    ),
    told(
        "a derivative is another state's",
        '<Real derivative="30" />',
        '<Real derivative="31" />',
        "derivative",
        "rates",
    ),
    told(
        "a derivative is that of no variable",
        '<Real derivative="30" />',
        '<Real derivative="99" />',
        "model-description",
        "description",
    ),
    told(
        "an attribute is not one of FMI 2.0",
        'numberOfEventIndicators="0"',
        'numberOfEvents="0"',
        "model-description",
        "description",
    ),
    told(
        "the file is no XML",
        "</ModelVariables>",
        "",
        "cannot be read",
        None,
    ),
    told(
        "the default experiment ends before it starts",
        'stopTime="20.0"',
        'stopTime="-1.0"',
        "default-experiment",
        "description",
    ),
    told(
        "a log category is not declared",
        '    <Category name="logStatusError" description="Calls that were refused, with the reason." />\n',
        "",
        "logger-category",
        "messages",
    ),
    told(
        "an output is out of its range",
        '<Real unit="m/s" />',
        '<Real unit="m/s" max="-1.0" />',
        "out-of-range",
        "values",
    ),
    told(
        "a parameter that can be changed is declared fixed",
        'causality="parameter" variability="tunable" initial="exact">\n      <Real unit="s"',
        'causality="parameter" variability="fixed" initial="exact">\n      <Real unit="s"',
        "set-fixed",
        "values",
    ),
    told(
        "the time is another variable",
        "  </ModelVariables>",
        '    <ScalarVariable name="time" valueReference="8" causality="independent" '
        'variability="continuous">\n      <Real />\n    </ScalarVariable>\n  </ModelVariables>',
        "time-variable",
        "steps",
    ),
    Fault(
        "a derivative has the unit of its state",
        (
            Edit(
                DESCRIPTION,
                'valueReference="22" description="modal amplitude, mass-normalised" causality="local" '
                'variability="continuous" initial="exact">\n      <Real ',
                'valueReference="22" description="modal amplitude, mass-normalised" causality="local" '
                'variability="continuous" initial="exact">\n      <Real unit="m" ',
            ),
            Edit(DESCRIPTION, '<Real derivative="23" />', '<Real unit="m" derivative="23" />'),
        ),
        "unit-derivative",
        "description",
    ),
)
STRUCTURE = (
    told(
        "an output depends on one input more than it says",
        '<Unknown index="6" dependencies="1 2 3 25',
        '<Unknown index="6" dependencies="1 2 25',
        "dependencies-missing",
        "structure",
    ),
    told(
        "an output depends on no input, but all are listed",
        '<Unknown index="4" dependencies="23 24 25 26 27 28" />',
        '<Unknown index="4" dependencies="1 2 3 23 24 25 26 27 28" />',
        "dependencies-unused",
        "structure",
    ),
    told(
        "an output depends on a state more than it says",
        '<Unknown index="8" dependencies="23 24 25 26 27 28" />',
        '<Unknown index="8" dependencies="23 24 25 26 27" />',
        "dependencies-missing",
        "structure",
    ),
    told(
        "the derivative of a state depends on an input more than it says",
        '<Unknown index="43" dependencies="1 2 3 25 31" />',
        '<Unknown index="43" dependencies="1 3 25 31" />',
        "dependencies-missing",
        "structure",
    ),
    told(
        "an initial value depends on a parameter more than it says",
        '<Unknown index="19" dependencies="9 10" />',
        '<Unknown index="19" dependencies="10" />',
        "dependencies-missing",
        "structure",
    ),
    told(
        "an output is not in the structure",
        '      <Unknown index="7" dependencies="1 2 3 25 26 27 28 29 30 31 32 33 34" />\n',
        "",
        "model-description",
        "description",
    ),
    told(
        "an input is listed as an output",
        '      <Unknown index="7" dependencies="1 2 3 25',
        '      <Unknown index="3" dependencies="" />\n      <Unknown index="7" dependencies="1 2 3 25',
        "model-description",
        "description",
    ),
    told(
        "an initial unknown is not in the structure",
        '      <Unknown index="18" dependencies="" />\n',
        "",
        "model-description",
        "description",
    ),
    told(
        "the derivative of a state is not in the structure",
        '      <Unknown index="35" dependencies="29" />\n',
        "",
        "model-description",
        "description",
    ),
    told(
        "a dependency is no variable",
        '<Unknown index="19" dependencies="9 10" />',
        '<Unknown index="19" dependencies="9 100" />',
        "model-structure",
        "description",
    ),
    told(
        "an output depends on another output",
        '<Unknown index="4" dependencies="23 24 25 26 27 28" />',
        '<Unknown index="4" dependencies="5 23 24 25 26 27 28" />',
        "dependencies-unknown",
        "description",
    ),
)
CAPABILITIES = (
    told(
        "output derivatives are declared up to an order that is not there",
        'maxOutputDerivativeOrder="2"',
        'maxOutputDerivativeOrder="3"',
        "output-derivative",
        "rates",
    ),
    told(
        "states can be serialised but not saved",
        'maxOutputDerivativeOrder="2" canNotUseMemoryManagementFunctions="false" canGetAndSetFMUstate="true"',
        'maxOutputDerivativeOrder="2" canNotUseMemoryManagementFunctions="false" '
        'canGetAndSetFMUstate="false"',
        "capabilities",
        "description",
    ),
    told(
        "memory of the host is not used by declaration only",
        'maxOutputDerivativeOrder="2" canNotUseMemoryManagementFunctions="false"',
        'maxOutputDerivativeOrder="2" canNotUseMemoryManagementFunctions="true"',
        "memory-functions",
        "arguments",
    ),
    told(
        "dependencies on states are listed without directional derivatives",
        'canSerializeFMUstate="true" providesDirectionalDerivative="true">\n    <SourceFiles>\n      '
        '<File name="modalfmu.c" />\n    </SourceFiles>\n  </CoSimulation>',
        'canSerializeFMUstate="true">\n    <SourceFiles>\n      '
        '<File name="modalfmu.c" />\n    </SourceFiles>\n  </CoSimulation>',
        "state-dependencies",
        "description",
    ),
)
