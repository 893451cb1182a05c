//! Every rule on a description that breaks it and no other.

use super::super::findings::{FmuFindings, FmuSeverity};
use super::check;
use crate::xml::Element;

/// A description without a flaw: time, tunable parameter, inputs, state, output, calculated parameter, string.
const GOOD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Sdof" guid="{1}" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="sdof" canHandleVariableCommunicationStepSize="true"/>
  <UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/></Unit>
    <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Angle"><Real unit="rad" displayUnit="deg" min="-1" max="1"/></SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name="logAll"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="time" valueReference="0" causality="independent" variability="continuous"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="1" causality="parameter" variability="tunable"><Real start="2" min="0"/></ScalarVariable>
    <ScalarVariable name="u" valueReference="2" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="3" causality="output" initial="exact"><Real declaredType="Angle" start="0.5"/></ScalarVariable>
    <ScalarVariable name="der(x)" valueReference="4" initial="calculated"><Real derivative="4"/></ScalarVariable>
    <ScalarVariable name="w" valueReference="5" causality="calculatedParameter" variability="tunable"><Real/></ScalarVariable>
    <ScalarVariable name="n" valueReference="0" causality="output" variability="constant"><Integer start="3"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="6" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="4" dependencies=""/><Unknown index="7"/><Unknown index="8" dependencies="3 4" dependenciesKind="dependent constant"/></Outputs>
    <Derivatives><Unknown index="5" dependencies="3 4"/></Derivatives>
    <InitialUnknowns><Unknown index="5"/><Unknown index="6" dependencies="2"/><Unknown index="8"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

fn errors(text: &str) -> Vec<String> {
    let mut all = FmuFindings::default();
    let description = all.description(&Element::parse(text).unwrap());
    check(&description, &mut all);
    all.0
        .iter()
        .filter(|f| f.severity == FmuSeverity::Error)
        .map(ToString::to_string)
        .collect()
}

#[test]
fn a_flawless_description_gives_no_finding() {
    let mut findings = FmuFindings::default();
    let description = findings.description(&Element::parse(GOOD).unwrap());
    check(&description, &mut findings);
    assert_eq!(findings.0, []);
    assert_eq!(description.variables.len(), 8);
    assert_eq!(description.outputs[0].dependencies, Some(vec![]));
    assert_eq!(description.outputs[1].dependencies, None);
    let x = description.variable("x").unwrap();
    assert_eq!(
        x.attribute(&description.types_by_name(), |a| a.max),
        Some(1.0)
    );
}

/// (what stands, what is put there, words of the one error).
const DEFECTS: [(&str, &str, &[&str]); 41] = [
    // the rows of the table of what other checkers find and miss
    (
        r#"unit="m" start="0"/>"#,
        r#"unit="m"/>"#,
        &["`u`", "a start value", "none"],
    ),
    (r#"name="w""#, r#"name="y""#, &["unique names", "`y` twice"]),
    (
        r#"<Unknown index="7"/>"#,
        "",
        &["`n`", "listed in <Outputs>"],
    ),
    (
        r#"<Unknown index="6" dependencies="2"/>"#,
        "",
        &["`w`", "listed in <InitialUnknowns>"],
    ),
    (
        r#"causality="input">"#,
        r#"causality="input" initial="exact">"#,
        &["`u`", "no `initial` on an input"],
    ),
    (
        r#"unit="m" start"#,
        r#"unit="mm" start"#,
        &["`u`", "`mm`, which is not defined"],
    ),
    (
        r#"name="u" valueReference="2""#,
        r#"name="u" valueReference="3""#,
        &["one settable variable for value reference 3", "`u`, `x`"],
    ),
    (
        r#"dependencies="3 4" dep"#,
        r#"dependencies="3 40" dep"#,
        &["dependencies in 1 .. 8", "40"],
    ),
    (r#"guid="{1}""#, r#"guid=" ""#, &["guid", "empty"]),
    (
        r#"start="0.5""#,
        r#"start="1.5""#,
        &["`x`", "a start value in -1 .. 1", "1.5"],
    ),
    // heads and lists
    (
        r#"fmiVersion="2.0""#,
        r#"fmiVersion="1.0""#,
        &["fmiVersion", "`1.0`"],
    ),
    (r#" modelName="Sdof""#, "", &["the attribute `modelName`"]),
    (
        r#"modelIdentifier="sdof""#,
        r#"modelIdentifier="s-dof""#,
        &["C identifier", "`s-dof`"],
    ),
    (
        r#"StepSize="true""#,
        r#"StepSize="yes""#,
        &["true or false", "`yes`"],
    ),
    (
        r#"StepSize="true""#,
        r#"StepSize="true" canSerializeFMUstate="true""#,
        &["canGetAndSetFMUstate along with it"],
    ),
    (r#"<Category name="logAll"/>"#, "", &["an empty list"]),
    (r#"stopTime="1""#, r#"stopTime="-1""#, &["stopTime", "-1"]),
    (
        r#"stepSize="0.01""#,
        r#"stepSize="0""#,
        &["stepSize", "positive"],
    ),
    (r#"stopTime="1""#, r#"stopTime="INF""#, &["finite", "`INF`"]),
    (
        "<LogCategories>",
        "<Odd/><LogCategories>",
        &["FMI 2.0 schema", "<Odd>"],
    ),
    (
        r#"<DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>"#,
        "<TypeDefinitions><x/></TypeDefinitions>",
        &["<TypeDefinitions> before <LogCategories>"],
    ),
    // units and types
    (
        r#"displayUnit="deg""#,
        r#"displayUnit="grad""#,
        &["a display unit of `rad`", "`grad`"],
    ),
    (
        r#"<Unit name="m">"#,
        r#"<Unit name="rad">"#,
        &["each unit once"],
    ),
    (
        r#"factor="57.29577951308232""#,
        r#"factor="0""#,
        &["`deg`", "other than 0"],
    ),
    (
        r#"<Real start="2""#,
        r#"<Real displayUnit="deg" start="2""#,
        &["`k`", "a unit for the display unit"],
    ),
    (
        r#"declaredType="Angle""#,
        r#"declaredType="Angel""#,
        &["`x`", "`Angel`, which is not defined"],
    ),
    // variables
    (
        r#"causality="input""#,
        r#"causality="entry""#,
        &["one of parameter", "`entry`"],
    ),
    (
        r#"causality="input""#,
        r#"causality="input" variability="fixed""#,
        &["`u`", "legal combination", "input and fixed"],
    ),
    (
        r#"causality="output" variability="constant""#,
        r#"causality="output""#,
        &["`n`", "not Real", "means continuous"],
    ),
    (
        r#"variability="tunable"><Real/>"#,
        r#"variability="tunable" initial="exact"><Real start="1"/>"#,
        &["`w`", "approx, calculated", "exact"],
    ),
    (
        r#"<Real derivative="4"/>"#,
        r#"<Real derivative="4" start="1"/>"#,
        &["`der(x)`", "no start value"],
    ),
    (
        r#"<Real derivative="4"/>"#,
        r#"<Real derivative="14"/>"#,
        &["`der(x)`", "1 .. 8", "14"],
    ),
    (
        r#"<Real start="2" min="0"/>"#,
        r#"<Real start="2" min="0" max="-1"/>"#,
        &["max not below min"],
    ),
    (
        r#"<Integer start="3"/>"#,
        r#"<Integer start="3.5"/>"#,
        &["whole number", "`3.5`"],
    ),
    (
        r#"name="u""#,
        r#"name="u v""#,
        &["structured name", "`u v`"],
    ),
    (
        r#"name="w" valueReference="5""#,
        r#"name="w" valueReference="-5""#,
        &["valueReference", "`-5`"],
    ),
    // structure
    (
        r#"<Unknown index="5"/>"#,
        r#"<Unknown index="5"/><Unknown index="3"/>"#,
        &["InitialUnknowns, index 3", "`u`"],
    ),
    (
        r#"dependenciesKind="dependent constant""#,
        r#"dependenciesKind="dependent""#,
        &["2 words", "1"],
    ),
    (
        r#"dependenciesKind="dependent constant""#,
        r#"dependenciesKind="dependent linear""#,
        &["`linear`"],
    ),
    (
        r#"<Unknown index="8"/></Init"#,
        r#"<Unknown index="8"/><Unknown index="80"/></Init"#,
        &["an index in 1 .. 8", "80"],
    ),
    (
        r#"<Unknown index="5" dependencies="3 4"/>"#,
        r#"<Unknown index="8" dependencies="3 4"/>"#,
        &["`derivative`", "`y` without"],
    ),
];

#[test]
fn every_defect_is_found_with_place_and_reason() {
    for (stands, put, words) in DEFECTS {
        assert_eq!(GOOD.matches(stands).count(), 1, "{stands}");
        let found = errors(&GOOD.replace(stands, put));
        let hit = found.iter().find(|e| words.iter().all(|w| e.contains(w)));
        assert!(hit.is_some(), "{put}: {found:#?}");
    }
}

#[test]
fn an_fmu_for_model_exchange_only_is_named_as_such() {
    let text = GOOD.replace("<CoSimulation", "<ModelExchange");
    assert!(
        errors(&text)
            .iter()
            .any(|e| e.contains("no <CoSimulation>"))
    );
}

/// Hundreds of thousands of names that come twice, types and units: looked up, not searched for.
#[test]
fn long_descriptions_are_checked_in_linear_time() {
    const MANY: usize = 150_000;
    let (mut variables, mut types, mut units) = (String::new(), String::new(), String::new());
    for i in 0..MANY {
        for reference in [i, 7] {
            variables += &format!(
                r#"<ScalarVariable name="v{i}" valueReference="{reference}" causality="input"><Real declaredType="T{i}" unit="u{i}" start="0"/></ScalarVariable>"#
            );
        }
        types += &format!(r#"<SimpleType name="T{i}"><Real unit="u{i}"/></SimpleType>"#);
        units += &format!(r#"<Unit name="u{i}"/>"#);
    }
    let text = GOOD
        .replace(
            "</ModelVariables>",
            &format!("{variables}</ModelVariables>"),
        )
        .replace("</TypeDefinitions>", &format!("{types}</TypeDefinitions>"))
        .replace("</UnitDefinitions>", &format!("{units}</UnitDefinitions>"));
    let begin = std::time::Instant::now();
    let found = errors(&text);
    // a second here; a search for each name takes many minutes
    assert!(begin.elapsed().as_secs() < 60);
    assert!(found.iter().filter(|f| f.contains("unique names")).count() == MANY);
    assert!(found.iter().all(|f| f.len() < 400), "one line each");
}
