"""A spring and a damper in parallel as an FMU: what the rest of a system does to a port."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class SpringDamper(Fmi2Slave):
    """force = −k x − c v at the end of the step, of the x and v that were set before it."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.stiffness, self.damping = 500.0, 3.0  # N/m, N.s/m
        self.x = self.v = self.force = 0.0
        for name in ("stiffness", "damping", "x", "v"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("force", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.force = -self.stiffness * self.x - self.damping * self.v
        return True
