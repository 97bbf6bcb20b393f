"""Faults of the archive: files that are missing, elsewhere, or another FMU's."""

from planted import DESCRIPTION, LIBRARY, NAME, Edit, Fault, Move

from precompute.ls_ref import FOLDER

ARCHIVE = (
    Fault(
        "an array of the model is missing",
        (Move("resources/model/B.npy", None),),
        "instantiation",
        "begin",
    ),
    Fault(
        "the resources were changed by hand",
        (Edit("resources/model/model.json", '"alpha": 0.3', '"alpha": 0.4'),),
        "instantiation",
        "begin",
    ),
    Fault(
        "the library is for another platform",
        (Move(LIBRARY, f"binaries/win64/{NAME}.dll"),),
        "got binaries for win64, expected linux64",
        None,
    ),
    Fault(
        "the library has another name than modelIdentifier",
        (Move(LIBRARY, "binaries/linux64/part.so"),),
        "library-loads",
        "begin",
    ),
    Fault(
        "there is no description",
        (Move(DESCRIPTION, None),),
        "got a zip without",
        None,
    ),
    Fault(
        "everything lies in a folder of the archive",
        (Move(DESCRIPTION, f"{NAME}/{DESCRIPTION}"),),
        "got a zip without",
        None,
    ),
    Fault(
        "a path leads out of the archive",
        (Move("sources/README.txt", "../README.txt"),),
        "leads out of the FMU",
        None,
    ),
    Fault(
        "a source that is declared is missing",
        (Move("sources/modalfmu.c", None),),
        "files-missing",
        "description",
    ),
    Fault(
        "the reference results are another model's",
        (Edit(f"{FOLDER}/step-ref.csv", "\n0.2,", "\n0.2,1"),),
        "reference-results",
        "references",
    ),
    Fault(
        "the reference results are not there",
        (Move(f"{FOLDER}/step-ref.csv", None),),
        "reference-results",
        "references",
    ),
)
