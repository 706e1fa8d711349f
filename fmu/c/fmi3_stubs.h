/* Made by tools/make_fmi_stubs.py. */

EXPORT fmi3Instance fmi3InstantiateModelExchange(
    fmi3String instanceName,
    fmi3String instantiationToken,
    fmi3String resourcePath,
    fmi3Boolean visible,
    fmi3Boolean loggingOn,
    fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage) {
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)instanceEnvironment;
    (void)logMessage;
    if (logMessage)
        logMessage(instanceEnvironment, fmi3Error, CATEGORY,
                   "fmi3InstantiateModelExchange: expected co-simulation");
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName,
    fmi3String instantiationToken,
    fmi3String resourcePath,
    fmi3Boolean visible,
    fmi3Boolean loggingOn,
    fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate,
    fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption) {
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)instanceEnvironment;
    (void)logMessage;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    if (logMessage)
        logMessage(instanceEnvironment, fmi3Error, CATEGORY,
                   "fmi3InstantiateScheduledExecution: expected co-simulation");
    return NULL;
}

EXPORT fmi3Status fmi3EnterEventMode(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3EnterEventMode: not part of this export");
}

EXPORT fmi3Status fmi3GetFloat32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Float32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetFloat32: not part of this export");
}

EXPORT fmi3Status fmi3GetInt8(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Int8 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetInt8: not part of this export");
}

EXPORT fmi3Status fmi3GetUInt8(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt8 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetUInt8: not part of this export");
}

EXPORT fmi3Status fmi3GetInt16(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Int16 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetInt16: not part of this export");
}

EXPORT fmi3Status fmi3GetUInt16(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt16 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetUInt16: not part of this export");
}

EXPORT fmi3Status fmi3GetInt32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Int32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetInt32: not part of this export");
}

EXPORT fmi3Status fmi3GetUInt32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetUInt32: not part of this export");
}

EXPORT fmi3Status fmi3GetUInt64(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt64 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetUInt64: not part of this export");
}

EXPORT fmi3Status fmi3GetBoolean(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Boolean values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetBoolean: not part of this export");
}

EXPORT fmi3Status fmi3GetString(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3String values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetString: not part of this export");
}

EXPORT fmi3Status fmi3GetBinary(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    size_t valueSizes[],
    fmi3Binary values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)valueSizes;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetBinary: not part of this export");
}

EXPORT fmi3Status fmi3GetClock(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Clock values[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    SELF;
    return FAILS("fmi3GetClock: not part of this export");
}

EXPORT fmi3Status fmi3SetFloat32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Float32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetFloat32: not part of this export");
}

EXPORT fmi3Status fmi3SetInt8(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Int8 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetInt8: not part of this export");
}

EXPORT fmi3Status fmi3SetUInt8(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt8 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetUInt8: not part of this export");
}

EXPORT fmi3Status fmi3SetInt16(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Int16 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetInt16: not part of this export");
}

EXPORT fmi3Status fmi3SetUInt16(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt16 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetUInt16: not part of this export");
}

EXPORT fmi3Status fmi3SetInt32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Int32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetInt32: not part of this export");
}

EXPORT fmi3Status fmi3SetUInt32(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt32 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetUInt32: not part of this export");
}

EXPORT fmi3Status fmi3SetInt64(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Int64 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetInt64: not part of this export");
}

EXPORT fmi3Status fmi3SetUInt64(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt64 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetUInt64: not part of this export");
}

EXPORT fmi3Status fmi3SetBoolean(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Boolean values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetBoolean: not part of this export");
}

EXPORT fmi3Status fmi3SetString(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3String values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetString: not part of this export");
}

EXPORT fmi3Status fmi3SetBinary(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const size_t valueSizes[],
    const fmi3Binary values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)valueSizes;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3SetBinary: not part of this export");
}

EXPORT fmi3Status fmi3SetClock(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Clock values[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)values;
    SELF;
    return FAILS("fmi3SetClock: not part of this export");
}

EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(
    fmi3Instance instance,
    fmi3ValueReference valueReference,
    size_t* nDependencies) {
    (void)valueReference;
    (void)nDependencies;
    SELF;
    return FAILS("fmi3GetNumberOfVariableDependencies: not part of this export");
}

EXPORT fmi3Status fmi3GetVariableDependencies(
    fmi3Instance instance,
    fmi3ValueReference dependent,
    size_t elementIndicesOfDependent[],
    fmi3ValueReference independents[],
    size_t elementIndicesOfIndependents[],
    fmi3DependencyKind dependencyKinds[],
    size_t nDependencies) {
    (void)dependent;
    (void)elementIndicesOfDependent;
    (void)independents;
    (void)elementIndicesOfIndependents;
    (void)dependencyKinds;
    (void)nDependencies;
    SELF;
    return FAILS("fmi3GetVariableDependencies: not part of this export");
}

EXPORT fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance,
    const fmi3ValueReference unknowns[],
    size_t nUnknowns,
    const fmi3ValueReference knowns[],
    size_t nKnowns,
    const fmi3Float64 seed[],
    size_t nSeed,
    fmi3Float64 sensitivity[],
    size_t nSensitivity) {
    (void)unknowns;
    (void)nUnknowns;
    (void)knowns;
    (void)nKnowns;
    (void)seed;
    (void)nSeed;
    (void)sensitivity;
    (void)nSensitivity;
    SELF;
    return FAILS("fmi3GetDirectionalDerivative: not part of this export");
}

EXPORT fmi3Status fmi3GetAdjointDerivative(
    fmi3Instance instance,
    const fmi3ValueReference unknowns[],
    size_t nUnknowns,
    const fmi3ValueReference knowns[],
    size_t nKnowns,
    const fmi3Float64 seed[],
    size_t nSeed,
    fmi3Float64 sensitivity[],
    size_t nSensitivity) {
    (void)unknowns;
    (void)nUnknowns;
    (void)knowns;
    (void)nKnowns;
    (void)seed;
    (void)nSeed;
    (void)sensitivity;
    (void)nSensitivity;
    SELF;
    return FAILS("fmi3GetAdjointDerivative: not part of this export");
}

EXPORT fmi3Status fmi3EnterConfigurationMode(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3EnterConfigurationMode: not part of this export");
}

EXPORT fmi3Status fmi3ExitConfigurationMode(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3ExitConfigurationMode: not part of this export");
}

EXPORT fmi3Status fmi3GetIntervalDecimal(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Float64 intervals[],
    fmi3IntervalQualifier qualifiers[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)intervals;
    (void)qualifiers;
    SELF;
    return FAILS("fmi3GetIntervalDecimal: not part of this export");
}

EXPORT fmi3Status fmi3GetIntervalFraction(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt64 counters[],
    fmi3UInt64 resolutions[],
    fmi3IntervalQualifier qualifiers[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    SELF;
    return FAILS("fmi3GetIntervalFraction: not part of this export");
}

EXPORT fmi3Status fmi3GetShiftDecimal(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3Float64 shifts[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)shifts;
    SELF;
    return FAILS("fmi3GetShiftDecimal: not part of this export");
}

EXPORT fmi3Status fmi3GetShiftFraction(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    fmi3UInt64 counters[],
    fmi3UInt64 resolutions[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)counters;
    (void)resolutions;
    SELF;
    return FAILS("fmi3GetShiftFraction: not part of this export");
}

EXPORT fmi3Status fmi3SetIntervalDecimal(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Float64 intervals[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)intervals;
    SELF;
    return FAILS("fmi3SetIntervalDecimal: not part of this export");
}

EXPORT fmi3Status fmi3SetIntervalFraction(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt64 counters[],
    const fmi3UInt64 resolutions[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)counters;
    (void)resolutions;
    SELF;
    return FAILS("fmi3SetIntervalFraction: not part of this export");
}

EXPORT fmi3Status fmi3SetShiftDecimal(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Float64 shifts[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)shifts;
    SELF;
    return FAILS("fmi3SetShiftDecimal: not part of this export");
}

EXPORT fmi3Status fmi3SetShiftFraction(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3UInt64 counters[],
    const fmi3UInt64 resolutions[]) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)counters;
    (void)resolutions;
    SELF;
    return FAILS("fmi3SetShiftFraction: not part of this export");
}

EXPORT fmi3Status fmi3EvaluateDiscreteStates(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3EvaluateDiscreteStates: not part of this export");
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(
    fmi3Instance instance,
    fmi3Boolean* discreteStatesNeedUpdate,
    fmi3Boolean* terminateSimulation,
    fmi3Boolean* nominalsOfContinuousStatesChanged,
    fmi3Boolean* valuesOfContinuousStatesChanged,
    fmi3Boolean* nextEventTimeDefined,
    fmi3Float64* nextEventTime) {
    (void)discreteStatesNeedUpdate;
    (void)terminateSimulation;
    (void)nominalsOfContinuousStatesChanged;
    (void)valuesOfContinuousStatesChanged;
    (void)nextEventTimeDefined;
    (void)nextEventTime;
    SELF;
    return FAILS("fmi3UpdateDiscreteStates: not part of this export");
}

EXPORT fmi3Status fmi3EnterContinuousTimeMode(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3EnterContinuousTimeMode: not part of this export");
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(
    fmi3Instance instance,
    fmi3Boolean noSetFMUStatePriorToCurrentPoint,
    fmi3Boolean* enterEventMode,
    fmi3Boolean* terminateSimulation) {
    (void)noSetFMUStatePriorToCurrentPoint;
    (void)enterEventMode;
    (void)terminateSimulation;
    SELF;
    return FAILS("fmi3CompletedIntegratorStep: not part of this export");
}

EXPORT fmi3Status fmi3SetTime(
    fmi3Instance instance,
    fmi3Float64 time) {
    (void)time;
    SELF;
    return FAILS("fmi3SetTime: not part of this export");
}

EXPORT fmi3Status fmi3SetContinuousStates(
    fmi3Instance instance,
    const fmi3Float64 continuousStates[],
    size_t nContinuousStates) {
    (void)continuousStates;
    (void)nContinuousStates;
    SELF;
    return FAILS("fmi3SetContinuousStates: not part of this export");
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(
    fmi3Instance instance,
    fmi3Float64 derivatives[],
    size_t nContinuousStates) {
    (void)derivatives;
    (void)nContinuousStates;
    SELF;
    return FAILS("fmi3GetContinuousStateDerivatives: not part of this export");
}

EXPORT fmi3Status fmi3GetEventIndicators(
    fmi3Instance instance,
    fmi3Float64 eventIndicators[],
    size_t nEventIndicators) {
    (void)eventIndicators;
    (void)nEventIndicators;
    SELF;
    return FAILS("fmi3GetEventIndicators: not part of this export");
}

EXPORT fmi3Status fmi3GetContinuousStates(
    fmi3Instance instance,
    fmi3Float64 continuousStates[],
    size_t nContinuousStates) {
    (void)continuousStates;
    (void)nContinuousStates;
    SELF;
    return FAILS("fmi3GetContinuousStates: not part of this export");
}

EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(
    fmi3Instance instance,
    fmi3Float64 nominals[],
    size_t nContinuousStates) {
    (void)nominals;
    (void)nContinuousStates;
    SELF;
    return FAILS("fmi3GetNominalsOfContinuousStates: not part of this export");
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(
    fmi3Instance instance,
    size_t* nEventIndicators) {
    (void)nEventIndicators;
    SELF;
    return FAILS("fmi3GetNumberOfEventIndicators: not part of this export");
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(
    fmi3Instance instance,
    size_t* nContinuousStates) {
    (void)nContinuousStates;
    SELF;
    return FAILS("fmi3GetNumberOfContinuousStates: not part of this export");
}

EXPORT fmi3Status fmi3EnterStepMode(
    fmi3Instance instance) {
    SELF;
    return FAILS("fmi3EnterStepMode: not part of this export");
}

EXPORT fmi3Status fmi3GetOutputDerivatives(
    fmi3Instance instance,
    const fmi3ValueReference valueReferences[],
    size_t nValueReferences,
    const fmi3Int32 orders[],
    fmi3Float64 values[],
    size_t nValues) {
    (void)valueReferences;
    (void)nValueReferences;
    (void)orders;
    (void)values;
    (void)nValues;
    SELF;
    return FAILS("fmi3GetOutputDerivatives: not part of this export");
}

EXPORT fmi3Status fmi3ActivateModelPartition(
    fmi3Instance instance,
    fmi3ValueReference clockReference,
    fmi3Float64 activationTime) {
    (void)clockReference;
    (void)activationTime;
    SELF;
    return FAILS("fmi3ActivateModelPartition: not part of this export");
}
