"""FMPy as an importer, of both versions."""

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave


class Slave:
    """An instance of an export, which is ready to be stepped unless `begin` is False."""

    def __init__(self, path, start=0.0, stop=None, begin=True, token=None, **options):
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        self.version = int(self.description.fmiVersion[0])
        self.log = []
        kind = {2: FMU2Slave, 3: FMU3Slave}[self.version]
        self.fmu = kind(
            guid=token or self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.open = False
        try:
            self.fmu.instantiate(**self._logging(), **options)
        except Exception as error:
            raise RuntimeError(f"cannot instantiate: {self.log}") from error
        self.open = True
        self.numbers = {v.name: v.valueReference for v in self.description.modelVariables}
        self.outputs = [v for v in self.description.modelVariables if v.causality == "output"]
        if begin:
            self.begin(start, stop)

    def _logging(self):
        if self.version == 3:

            def tell(environment, status, category, message):
                self.log.append(message.decode())

            return {"logMessage": tell}

        def tell_2(environment, name, status, category, message):
            self.log.append(message.decode())

        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(tell_2)
        self._kept = callbacks
        return {"callbacks": callbacks}

    def begin(self, start=0.0, stop=None):
        if self.version == 2:
            self.fmu.setupExperiment(startTime=start, stopTime=stop)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start, stopTime=stop)
        self.fmu.exitInitializationMode()

    def set(self, **values):
        """Set variables by names in which "__" stands for a point."""
        self.set_named({name.replace("__", "."): value for name, value in values.items()})

    def set_named(self, values):
        for name, value in values.items():
            self.set_number(self.numbers[name], value)

    def set_number(self, number, value):
        write = self.fmu.setReal if self.version == 2 else self.fmu.setFloat64
        write([number], [value])

    def get_number(self, number):
        read = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return read([number])[0]

    def state_of(self, content):
        """A state of bytes."""
        if self.version == 2:
            return self.fmu.deSerializeFMUstate(content)
        return self.fmu.deserializeFMUState(content)

    def bytes_of(self, state):
        if self.version == 2:
            return self.fmu.serializeFMUstate(state)
        return self.fmu.serializeFMUState(state)

    def step(self, time, size):
        return self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=size)

    def values(self):
        """All outputs, in the order of the description."""
        reals = [v.valueReference for v in self.outputs if v.type in ("Real", "Float64")]
        whole = [v.valueReference for v in self.outputs if v.type in ("Integer", "Int64")]
        read = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        read_whole = self.fmu.getInteger if self.version == 2 else self.fmu.getInt64
        found = dict(zip(reals, read(reals), strict=True))
        if whole:
            found |= dict(zip(whole, read_whole(whole), strict=True))
        return np.array([found[v.valueReference] for v in self.outputs], dtype=float)

    def close(self):
        if self.open:
            self.open = False
            self.fmu.freeInstance()
