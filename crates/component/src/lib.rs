//! The runtime of an FMU as a component for WebAssembly, by the draft FMI-LS-WASM: a shell around the functions of FMI 3.0, in which
//! arrays travel as lists, an instance is a resource, a saved state is bytes, and the host reads the files of `resources/`.
#![allow(unsafe_code, reason = "the functions of FMI 3.0 take pointers")]

mod handle;
#[allow(missing_docs, unreachable_pub, reason = "written by a macro")]
mod interfaces {
    wit_bindgen::generate!({ world: "co-simulation-fmu", path: "wit" });
}

use aerodeck_unit::fmi2::types::{fmi2FMUstate, fmi2Status};
use aerodeck_unit::fmi3::*;
use handle::{Handle, answer, log, read, split, status};
use interfaces::exports::fmi::fmi3::{co_simulation, common};
use interfaces::fmi::fmi3::types::{
    DependencyKind, DiscreteStatesInfo, IntervalFraction, IntervalQualifier, Status,
    VariableDependency,
};
use std::ffi::{CStr, CString, c_char};
use std::ptr::null_mut;

impl common::Guest for Handle {
    fn get_version() -> String {
        "3.0".to_owned()
    }
}

impl co_simulation::Guest for Handle {
    type CoSimulationInstance = Handle;
}

macro_rules! variables {
    ($($get:ident, $c_get:ident, $set:ident, $c_set:ident, $type:ty;)*) => {$(
        fn $get(&self, of: Vec<u32>) -> Result<Vec<$type>, Status> {
            self.get($c_get, &of)
        }
        fn $set(&self, of: Vec<u32>, values: Vec<$type>) -> Status {
            self.set($c_set, &of, &values)
        }
    )*};
}

impl co_simulation::GuestCoSimulationInstance for Handle {
    fn instantiate_co_simulation(
        instance_name: String,
        instantiation_token: String,
        _visible: bool,
        logging_on: bool,
        _event_mode_used: bool,
        _early_return_allowed: bool,
        _required_intermediate_variables: Vec<u32>,
    ) -> Option<co_simulation::CoSimulationInstance> {
        let name = Box::new(CString::new(instance_name).unwrap_or_default());
        let environment = name.as_ptr().cast_mut().cast();
        let instance = instantiate_from_files(
            &name,
            &instantiation_token,
            logging_on,
            log,
            environment,
            &read,
        );
        let handle = Handle {
            instance,
            _name: name,
        };
        (!instance.is_null()).then(|| co_simulation::CoSimulationInstance::new(handle))
    }

    fn set_debug_logging(&self, logging_on: bool, categories: Vec<String>) -> Status {
        let texts = categories
            .into_iter()
            .map(|c| CString::new(c).unwrap_or_default());
        let texts: Vec<CString> = texts.collect();
        let texts: Vec<*const c_char> = texts.iter().map(|c| c.as_ptr()).collect();
        // SAFETY: as in `get`
        status(unsafe {
            fmi3SetDebugLogging(
                self.instance,
                logging_on.into(),
                texts.len(),
                texts.as_ptr(),
            )
        })
    }

    fn enter_initialization_mode(
        &self,
        tolerance: Option<f64>,
        start_time: f64,
        stop_time: Option<f64>,
    ) -> Status {
        let [tolerance_defined, stop_defined] =
            [tolerance, stop_time].map(|value| u8::from(value.is_some()));
        // SAFETY: an instance
        status(unsafe {
            fmi3EnterInitializationMode(
                self.instance,
                tolerance_defined,
                tolerance.unwrap_or_default(),
                start_time,
                stop_defined,
                stop_time.unwrap_or_default(),
            )
        })
    }

    fn exit_initialization_mode(&self) -> Status {
        self.call(fmi3ExitInitializationMode)
    }

    fn enter_event_mode(&self) -> Status {
        self.call(fmi3EnterEventMode)
    }

    fn update_discrete_states(&self) -> Result<DiscreteStatesInfo, Status> {
        let (mut flags, mut time_s) = ([false; 5], 0.0);
        let [a, b, c, d, e] = flags.each_mut().map(std::ptr::from_mut);
        // SAFETY: an instance, and places for the answers
        let done = unsafe { fmi3UpdateDiscreteStates(self.instance, a, b, c, d, e, &mut time_s) };
        let info = DiscreteStatesInfo {
            new_discrete_states_needed: flags[0],
            terminate_simulation: flags[1],
            nominals_of_continuous_states_changed: flags[2],
            values_of_continuous_states_changed: flags[3],
            next_event_time_defined: flags[4],
            next_event_time: time_s,
        };
        answer(done, info)
    }

    fn terminate(&self) -> Status {
        self.call(fmi3Terminate)
    }

    fn reset(&self) -> Status {
        self.call(fmi3Reset)
    }

    fn enter_configuration_mode(&self) -> Status {
        self.call(fmi3EnterConfigurationMode)
    }

    fn exit_configuration_mode(&self) -> Status {
        self.call(fmi3ExitConfigurationMode)
    }

    variables! {
        get_float32, fmi3GetFloat32, set_float32, fmi3SetFloat32, f32;
        get_float64, fmi3GetFloat64, set_float64, fmi3SetFloat64, f64;
        get_int8, fmi3GetInt8, set_int8, fmi3SetInt8, i8;
        get_int16, fmi3GetInt16, set_int16, fmi3SetInt16, i16;
        get_int32, fmi3GetInt32, set_int32, fmi3SetInt32, i32;
        get_int64, fmi3GetInt64, set_int64, fmi3SetInt64, i64;
        get_uint8, fmi3GetUInt8, set_uint8, fmi3SetUInt8, u8;
        get_uint16, fmi3GetUInt16, set_uint16, fmi3SetUInt16, u16;
        get_uint32, fmi3GetUInt32, set_uint32, fmi3SetUInt32, u32;
        get_uint64, fmi3GetUInt64, set_uint64, fmi3SetUInt64, u64;
        get_boolean, fmi3GetBoolean, set_boolean, fmi3SetBoolean, bool;
    }

    fn get_string(&self, of: Vec<u32>) -> Result<Vec<String>, Status> {
        // SAFETY: as in `get`; the texts live as long as the instance
        unsafe {
            let mut texts = vec![std::ptr::null(); count_of_values(self.instance, &of)];
            let count = texts.len();
            let (references, n) = (of.as_ptr(), of.len());
            let done = fmi3GetString(self.instance, references, n, texts.as_mut_ptr(), count);
            answer(done, ())?;
            let texts = texts.into_iter().map(|text| CStr::from_ptr(text));
            Ok(texts
                .map(|text| text.to_string_lossy().into_owned())
                .collect())
        }
    }

    fn get_binary(&self, of: Vec<u32>) -> Result<Vec<Vec<u8>>, Status> {
        let (references, n) = (of.as_ptr(), of.len());
        // SAFETY: as in `get`; there are no such variables, so that nothing is written
        let done =
            unsafe { fmi3GetBinary(self.instance, references, n, null_mut(), null_mut(), 0) };
        answer(done, Vec::new())
    }

    fn get_clock(&self, of: Vec<u32>) -> Result<Vec<bool>, Status> {
        // SAFETY: as in `get_binary`
        let done = unsafe { fmi3GetClock(self.instance, of.as_ptr(), of.len(), null_mut()) };
        answer(done, Vec::new())
    }

    fn set_string(&self, of: Vec<u32>, _values: Vec<String>) -> Status {
        self.set(fmi3SetString, &of, &[])
    }

    fn set_binary(&self, of: Vec<u32>, _values: Vec<Vec<u8>>) -> Status {
        let (references, n) = (of.as_ptr(), of.len());
        // SAFETY: as in `get_binary`
        status(unsafe { fmi3SetBinary(self.instance, references, n, null_mut(), null_mut(), 0) })
    }

    fn set_clock(&self, of: Vec<u32>, values: Vec<bool>) -> Status {
        let (references, n) = (of.as_ptr(), of.len());
        // SAFETY: as in `get_binary`
        status(unsafe { fmi3SetClock(self.instance, references, n, values.as_ptr()) })
    }

    fn get_number_of_variable_dependencies(&self, vr: u32) -> Result<u64, Status> {
        let mut count = 0;
        // SAFETY: an instance, and a place for the answer
        let done = unsafe { fmi3GetNumberOfVariableDependencies(self.instance, vr, &mut count) };
        answer(done, count as u64)
    }

    fn get_variable_dependencies(&self, of: u32) -> Result<Vec<VariableDependency>, Status> {
        let count = self.get_number_of_variable_dependencies(of)? as usize;
        let (mut own, mut elements) = (vec![0; count], vec![0; count]);
        let (mut on, mut kinds) = (vec![0; count], vec![0; count]);
        // SAFETY: an instance, and lists of that length
        let done = unsafe {
            fmi3GetVariableDependencies(
                self.instance,
                of,
                own.as_mut_ptr(),
                on.as_mut_ptr(),
                elements.as_mut_ptr(),
                kinds.as_mut_ptr(),
                count,
            )
        };
        answer(done, ())?;
        let dependency = |i: usize| VariableDependency {
            dependent_value_reference: of,
            // elements count from one in FMI 3.0, from zero in the draft
            element_index_of_dependent: own[i] as u32 - 1,
            independent_value_reference: on[i],
            element_index_of_independent: elements[i] as u32 - 1,
            kind: match kinds[i] {
                1 => DependencyKind::Constant,
                2 => DependencyKind::Fixed,
                3 => DependencyKind::Tunable,
                4 => DependencyKind::Discrete,
                _ => DependencyKind::Dependent,
            },
        };
        Ok((0..count).map(dependency).collect())
    }

    fn get_fmu_state(&self) -> Result<Vec<u8>, Status> {
        let mut state: fmi2FMUstate = null_mut();
        // SAFETY: an instance, and a state of its own that is freed here
        unsafe {
            answer(fmi3GetFMUState(self.instance, &mut state), ())?;
            let mut size = 0;
            let sized = fmi3SerializedFMUStateSize(self.instance, state, &mut size);
            let mut bytes = vec![0; size];
            let place = bytes.as_mut_ptr();
            let written = answer(sized, ())
                .map(|()| fmi3SerializeFMUState(self.instance, state, place, size));
            fmi3FreeFMUState(self.instance, &mut state);
            answer(written?, bytes)
        }
    }

    fn set_fmu_state(&self, bytes: Vec<u8>) -> Status {
        let mut state: fmi2FMUstate = null_mut();
        // SAFETY: an instance, bytes of that length, and a state of its own that is freed here
        unsafe {
            let place = &mut state;
            let read = fmi3DeserializeFMUState(self.instance, bytes.as_ptr(), bytes.len(), place);
            if read != fmi2Status::fmi2OK {
                return status(read);
            }
            let set = fmi3SetFMUState(self.instance, state);
            fmi3FreeFMUState(self.instance, &mut state);
            status(set)
        }
    }

    fn get_directional_derivative(
        &self,
        unknowns: Vec<u32>,
        knowns: Vec<u32>,
        seed: Vec<f64>,
    ) -> Result<Vec<f64>, Status> {
        let of = [&unknowns, &knowns, &unknowns].map(Vec::as_slice);
        self.derivative(fmi3GetDirectionalDerivative, of, &seed)
    }

    fn get_adjoint_derivative(
        &self,
        unknowns: Vec<u32>,
        knowns: Vec<u32>,
        seed: Vec<f64>,
    ) -> Result<Vec<f64>, Status> {
        let of = [&unknowns, &knowns, &knowns].map(Vec::as_slice);
        self.derivative(fmi3GetAdjointDerivative, of, &seed)
    }

    fn get_interval_decimal(&self, _: Vec<u32>) -> Result<Vec<(f64, IntervalQualifier)>, Status> {
        self.no_clocks("GetIntervalDecimal")
    }

    fn get_interval_fraction(
        &self,
        _: Vec<u32>,
    ) -> Result<Vec<(IntervalFraction, IntervalQualifier)>, Status> {
        self.no_clocks("GetIntervalFraction")
    }

    fn get_shift_decimal(&self, _: Vec<u32>) -> Result<Vec<f64>, Status> {
        self.no_clocks("GetShiftDecimal")
    }

    fn get_shift_fraction(&self, _: Vec<u32>) -> Result<Vec<IntervalFraction>, Status> {
        self.no_clocks("GetShiftFraction")
    }

    fn set_interval_decimal(&self, _: Vec<u32>, _: Vec<f64>) -> Status {
        self.refuse_clocks("SetIntervalDecimal")
    }

    fn set_interval_fraction(&self, _: Vec<u32>, _: Vec<IntervalFraction>) -> Status {
        self.refuse_clocks("SetIntervalFraction")
    }

    fn set_shift_decimal(&self, _: Vec<u32>, _: Vec<f64>) -> Status {
        self.refuse_clocks("SetShiftDecimal")
    }

    fn set_shift_fraction(&self, _: Vec<u32>, _: Vec<IntervalFraction>) -> Status {
        self.refuse_clocks("SetShiftFraction")
    }

    fn evaluate_discrete_states(&self) -> Status {
        self.call(fmi3EvaluateDiscreteStates)
    }

    fn set_input_derivatives(&self, requests: Vec<(u32, u32)>, values: Vec<f64>) -> Status {
        let (of, orders) = split(requests);
        // SAFETY: an instance
        status(unsafe { set_input_derivatives(self.instance, &of, &orders, &values) })
    }

    fn get_output_derivatives(&self, requests: Vec<(u32, u32)>) -> Result<Vec<f64>, Status> {
        let (of, orders) = split(requests);
        // SAFETY: as in `get`
        unsafe {
            let mut values = vec![0.0; count_of_values(self.instance, &of)];
            let (references, n) = (of.as_ptr(), of.len());
            let (place, count) = (values.as_mut_ptr(), values.len());
            let orders = orders.as_ptr();
            let done = fmi3GetOutputDerivatives(self.instance, references, n, orders, place, count);
            answer(done, values)
        }
    }

    fn do_step(
        &self,
        current_communication_point: f64,
        communication_step_size: f64,
        no_set_fmu_state_prior_to_current_point: bool,
    ) -> Result<co_simulation::DoStepResult, Status> {
        let (mut event, mut terminate, mut early, mut time_s) = (false, false, false, 0.0);
        // SAFETY: an instance, and places for the answers
        let done = unsafe {
            fmi3DoStep(
                self.instance,
                current_communication_point,
                communication_step_size,
                no_set_fmu_state_prior_to_current_point.into(),
                &mut event,
                &mut terminate,
                &mut early,
                &mut time_s,
            )
        };
        let result = co_simulation::DoStepResult {
            last_successful_time: time_s,
            event_handling_needed: event,
            terminate_simulation: terminate,
            early_return: early,
        };
        answer(done, result)
    }

    fn enter_step_mode(&self) -> Status {
        self.call(fmi3EnterStepMode)
    }
}

interfaces::export!(Handle with_types_in interfaces);
