/* Made by tools/make_fmi_stubs.py. */

EXPORT fmi2Status fmi2GetBoolean(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    fmi2Boolean value[]) {
    (void)vr;
    (void)nvr;
    (void)value;
    SELF;
    return FAILS("fmi2GetBoolean: not part of this export");
}

EXPORT fmi2Status fmi2GetString(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    fmi2String value[]) {
    (void)vr;
    (void)nvr;
    (void)value;
    SELF;
    return FAILS("fmi2GetString: not part of this export");
}

EXPORT fmi2Status fmi2SetInteger(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    const fmi2Integer value[]) {
    (void)vr;
    (void)nvr;
    (void)value;
    SELF;
    return FAILS("fmi2SetInteger: not part of this export");
}

EXPORT fmi2Status fmi2SetBoolean(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    const fmi2Boolean value[]) {
    (void)vr;
    (void)nvr;
    (void)value;
    SELF;
    return FAILS("fmi2SetBoolean: not part of this export");
}

EXPORT fmi2Status fmi2SetString(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    const fmi2String value[]) {
    (void)vr;
    (void)nvr;
    (void)value;
    SELF;
    return FAILS("fmi2SetString: not part of this export");
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component component,
    const fmi2ValueReference vUnknown_ref[],
    size_t nUnknown,
    const fmi2ValueReference vKnown_ref[],
    size_t nKnown,
    const fmi2Real dvKnown[],
    fmi2Real dvUnknown[]) {
    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    SELF;
    return FAILS("fmi2GetDirectionalDerivative: not part of this export");
}

EXPORT fmi2Status fmi2EnterEventMode(
    fmi2Component component) {
    SELF;
    return FAILS("fmi2EnterEventMode: not part of this export");
}

EXPORT fmi2Status fmi2NewDiscreteStates(
    fmi2Component component,
    fmi2EventInfo* fmi2eventInfo) {
    (void)fmi2eventInfo;
    SELF;
    return FAILS("fmi2NewDiscreteStates: not part of this export");
}

EXPORT fmi2Status fmi2EnterContinuousTimeMode(
    fmi2Component component) {
    SELF;
    return FAILS("fmi2EnterContinuousTimeMode: not part of this export");
}

EXPORT fmi2Status fmi2CompletedIntegratorStep(
    fmi2Component component,
    fmi2Boolean noSetFMUStatePriorToCurrentPoint,
    fmi2Boolean* enterEventMode,
    fmi2Boolean* terminateSimulation) {
    (void)noSetFMUStatePriorToCurrentPoint;
    (void)enterEventMode;
    (void)terminateSimulation;
    SELF;
    return FAILS("fmi2CompletedIntegratorStep: not part of this export");
}

EXPORT fmi2Status fmi2SetTime(
    fmi2Component component,
    fmi2Real time) {
    (void)time;
    SELF;
    return FAILS("fmi2SetTime: not part of this export");
}

EXPORT fmi2Status fmi2SetContinuousStates(
    fmi2Component component,
    const fmi2Real x[],
    size_t nx) {
    (void)x;
    (void)nx;
    SELF;
    return FAILS("fmi2SetContinuousStates: not part of this export");
}

EXPORT fmi2Status fmi2GetDerivatives(
    fmi2Component component,
    fmi2Real derivatives[],
    size_t nx) {
    (void)derivatives;
    (void)nx;
    SELF;
    return FAILS("fmi2GetDerivatives: not part of this export");
}

EXPORT fmi2Status fmi2GetEventIndicators(
    fmi2Component component,
    fmi2Real eventIndicators[],
    size_t ni) {
    (void)eventIndicators;
    (void)ni;
    SELF;
    return FAILS("fmi2GetEventIndicators: not part of this export");
}

EXPORT fmi2Status fmi2GetContinuousStates(
    fmi2Component component,
    fmi2Real x[],
    size_t nx) {
    (void)x;
    (void)nx;
    SELF;
    return FAILS("fmi2GetContinuousStates: not part of this export");
}

EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(
    fmi2Component component,
    fmi2Real x_nominal[],
    size_t nx) {
    (void)x_nominal;
    (void)nx;
    SELF;
    return FAILS("fmi2GetNominalsOfContinuousStates: not part of this export");
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    const fmi2Integer order[],
    const fmi2Real value[]) {
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    SELF;
    return FAILS("fmi2SetRealInputDerivatives: not part of this export");
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(
    fmi2Component component,
    const fmi2ValueReference vr[],
    size_t nvr,
    const fmi2Integer order[],
    fmi2Real value[]) {
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    SELF;
    return FAILS("fmi2GetRealOutputDerivatives: not part of this export");
}

EXPORT fmi2Status fmi2CancelStep(
    fmi2Component component) {
    SELF;
    return FAILS("fmi2CancelStep: not part of this export");
}

EXPORT fmi2Status fmi2GetStatus(
    fmi2Component component,
    const fmi2StatusKind s,
    fmi2Status* value) {
    (void)s;
    (void)value;
    SELF;
    return FAILS("fmi2GetStatus: not part of this export");
}

EXPORT fmi2Status fmi2GetIntegerStatus(
    fmi2Component component,
    const fmi2StatusKind s,
    fmi2Integer* value) {
    (void)s;
    (void)value;
    SELF;
    return FAILS("fmi2GetIntegerStatus: not part of this export");
}

EXPORT fmi2Status fmi2GetStringStatus(
    fmi2Component component,
    const fmi2StatusKind s,
    fmi2String* value) {
    (void)s;
    (void)value;
    SELF;
    return FAILS("fmi2GetStringStatus: not part of this export");
}
