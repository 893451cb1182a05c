//! Opening archives that are wrong, and one of our own.

use super::*;
use std::io::Write;
use zip::write::SimpleFileOptions;

const DESCRIPTION: &str = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
  <CoSimulation modelIdentifier="m"/>
  <ModelVariables>
    <ScalarVariable name="y" valueReference="0" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs><InitialUnknowns><Unknown index="1"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>"#;

fn archive_of(entries: &[(&str, &[u8])]) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    let mut zip = zip::ZipWriter::new(file.as_file_mut());
    for (name, bytes) in entries {
        let options = SimpleFileOptions::default();
        zip.start_file(*name, options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
    file
}

fn refusal(file: &Path) -> String {
    match Fmu::open(file) {
        Ok(_) => panic!("{} was opened", file.display()),
        Err(e) => e.to_string(),
    }
}

#[test]
fn what_is_no_fmu_is_refused_with_its_name() {
    let text = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(text.path(), "not an archive").unwrap();
    let message = refusal(text.path());
    assert!(message.starts_with(&text.path().display().to_string()));
    assert!(message.contains("expected a ZIP archive"), "{message}");

    assert!(refusal(Path::new("/nowhere/a.fmu")).starts_with("/nowhere/a.fmu: "));

    let empty = archive_of(&[("readme.txt", b"hello")]);
    let message = refusal(empty.path());
    assert!(message.contains("modelDescription.xml at its root, found readme.txt"));

    let broken = archive_of(&[("modelDescription.xml", b"<a>\n<b>\n</a>")]);
    let message = refusal(broken.path());
    assert!(
        message.contains("modelDescription.xml: line 3"),
        "{message}"
    );
}

#[test]
fn entries_that_lead_outside_are_refused() {
    for name in [
        "../evil.txt",
        "a/../../evil.txt",
        "/evil.txt",
        "C:/evil.txt",
    ] {
        let file = archive_of(&[
            (name, b"x"),
            ("modelDescription.xml", DESCRIPTION.as_bytes()),
        ]);
        let message = refusal(file.path());
        assert!(message.contains("a path inside the archive"), "{message}");
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn links_are_refused() {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    let mut zip = zip::ZipWriter::new(file.as_file_mut());
    zip.add_symlink("resources", "/etc", SimpleFileOptions::default())
        .unwrap();
    zip.finish().unwrap();
    assert!(refusal(file.path()).contains("found a link"));
}

#[test]
fn an_fmu_without_a_binary_for_this_machine_says_which_it_has() {
    let file = archive_of(&[
        ("modelDescription.xml", DESCRIPTION.as_bytes()),
        ("binaries/vax/m.so", b"x"),
        ("documentation/index.html", b"x"),
        ("model.png", b"x"),
    ]);
    let fmu = Fmu::open(file.path()).unwrap();
    assert_eq!(fmu.platforms(), ["vax"]);
    let report = fmu.check();
    assert_eq!(report.findings.len(), 1, "{:#?}", report.findings);
    assert!(report.findings[0].found.contains("binaries for vax"));
    assert!(!report.passed());
    assert!(fmu.instantiate("a").is_err());
    let folder = fmu.folder().to_path_buf();
    drop(fmu);
    assert!(!folder.exists());
}

#[test]
fn a_binary_that_is_none_is_a_finding() {
    let (folders, ending) = native();
    let binary = format!("binaries/{}/m.{ending}", folders[0]);
    let file = archive_of(&[
        ("modelDescription.xml", DESCRIPTION.as_bytes()),
        (&binary, b"no library"),
    ]);
    let report = Fmu::open(file.path()).unwrap().check();
    let errors: Vec<_> = report
        .findings
        .iter()
        .filter(|f| f.severity == FmuSeverity::Error)
        .collect();
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert!(errors[0].expected.contains("a library that loads"));
    assert_eq!(report.count(FmuSeverity::Note), 2);
}

/// The loader of the system would end this process with a bus error.
#[test]
#[cfg(target_os = "linux")]
fn a_library_that_is_cut_short_is_refused() {
    let own = std::env::current_exe().unwrap();
    let bytes = std::fs::read(own).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cut.so");
    for (part, said) in [
        (bytes.len() / 2, "too few for its segments"),
        (40, "too few"),
    ] {
        std::fs::write(&file, &bytes[..part]).unwrap();
        let refused = crate::library::open(&file).err();
        let refused = refused.unwrap().to_string();
        assert!(refused.contains(said), "{refused}");
    }
    // what the loader itself says is passed on
    std::fs::write(&file, b"no library").unwrap();
    let refused = crate::library::open(&file).err();
    let refused = refused.unwrap().to_string();
    assert!(refused.contains("cut.so"), "{refused}");
}

#[test]
fn descriptions_in_latin_1_are_read() {
    let text = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>".to_owned()
        + &DESCRIPTION.replace("modelName=\"m\"", "modelName=\"Br\u{fc}cke\"");
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let file = archive_of(&[("modelDescription.xml", &latin)]);
    let fmu = Fmu::open(file.path()).unwrap();
    assert_eq!(fmu.model_description().model_name, "Brücke");
}

/// A description with a control character is no XML, whatever a lenient reader makes of it.
#[test]
fn control_characters_are_found() {
    for name in ["a\u{1b}[31mb", "a&#1;b"] {
        let text = DESCRIPTION.replace("modelName=\"m\"", &format!("modelName=\"{name}\""));
        let file = archive_of(&[("modelDescription.xml", text.as_bytes())]);
        let message = refusal(file.path());
        assert!(message.contains("which XML cannot hold"), "{message}");
    }
}

#[test]
fn another_version_of_the_standard_is_named() {
    let found = found_in(&DESCRIPTION.replace("\"2.0\"", "\"1.0\""));
    assert_eq!(
        found,
        [
            "error: modelDescription.xml, fmiVersion: expected 2.0 (also for 2.0.1 to 2.0.5), or 3.0, found `1.0`"
        ]
    );
}

/// Nothing of an archive is loaded unless that is wanted, and the report says which.
#[test]
fn a_check_says_whether_it_ran_anything() {
    let file = archive_of(&[("modelDescription.xml", DESCRIPTION.as_bytes())]);
    let report = Fmu::open(file.path()).unwrap().check_without_running();
    assert_eq!(report.ran, None);
    assert!(report.trials.is_empty());
}

/// Entries may not unpack to more than the archive states, nor all together to more than the limit.
#[test]
fn archives_that_grow_are_refused() {
    let zeros = vec![0; 20_000_000];
    let entries: Vec<(String, &[u8])> = (0..14)
        .map(|i| (format!("extra/{i}"), &zeros[..]))
        .collect();
    let entries: Vec<(&str, &[u8])> = entries.iter().map(|(n, b)| (n.as_str(), *b)).collect();
    let message = refusal(archive_of(&entries).path());
    assert!(
        message.contains("at most 268435456 bytes unpacked in all"),
        "{message}"
    );

    // the directory at the end states a tenth of what is there
    let file = archive_of(&[("modelDescription.xml", &zeros[..1000])]);
    let mut bytes = std::fs::read(file.path()).unwrap();
    let stated = 1000_u32.to_le_bytes();
    let places: Vec<usize> = (0..bytes.len() - 4)
        .filter(|i| bytes[*i..*i + 4] == stated)
        .collect();
    for place in places {
        bytes[place..place + 4].copy_from_slice(&100_u32.to_le_bytes());
    }
    std::fs::write(file.path(), bytes).unwrap();
    let message = refusal(file.path());
    assert!(
        message.contains("modelDescription.xml") && message.contains("expected"),
        "{message}"
    );
}

const DESCRIPTION_3: &str = r#"<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t">
  <CoSimulation modelIdentifier="m" canGetAndSetFMUState="true" providesDirectionalDerivatives="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
  <TypeDefinitions><Float64Type name="Length" unit="m" min="0"/><ClockType name="tick"/></TypeDefinitions>
  <ModelVariables>
    <UInt64 name="n" valueReference="7" causality="structuralParameter" variability="fixed" start="3"/>
    <Float64 name="der(x)" valueReference="5" derivative="4" initial="calculated"><Dimension valueReference="7"/></Float64>
    <Float64 name="x" valueReference="4" causality="output" initial="exact" declaredType="Length" start="1 2 3"><Dimension valueReference="7"/></Float64>
    <Float32 name="u[1]" valueReference="3" causality="input" start="0.5"><Dimension start="2"/></Float32>
    <Clock name="tick" valueReference="9" causality="input" intervalVariability="triggered"/>
    <String name="s" valueReference="8" causality="parameter" variability="fixed"><Start value="hello"/></String>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="4" dependencies="3 9" dependenciesKind="dependent dependent"/>
    <ContinuousStateDerivative valueReference="5" dependencies=""/>
    <InitialUnknown valueReference="5"/>
  </ModelStructure>
</fmiModelDescription>"#;

/// Errors of the description alone; there is no binary.
fn found_in(description: &str) -> Vec<String> {
    let file = archive_of(&[("modelDescription.xml", description.as_bytes())]);
    let report = Fmu::open(file.path()).unwrap().check_without_running();
    let errors = report
        .findings
        .iter()
        .filter(|f| f.severity == FmuSeverity::Error);
    let errors = errors.filter(|f| !f.expected.contains("binary for this machine"));
    errors.map(ToString::to_string).collect()
}

#[test]
fn a_description_of_fmi3_is_read_element_by_element() {
    let file = archive_of(&[("modelDescription.xml", DESCRIPTION_3.as_bytes())]);
    let fmu = Fmu::open(file.path()).unwrap();
    let d = fmu.model_description();
    let names: Vec<&str> = d.variables.iter().map(|v| v.name.as_str()).collect();
    let arrays = [
        "der(x[1])",
        "der(x[2])",
        "der(x[3])",
        "x[1]",
        "x[2]",
        "x[3]",
        "u[1,1]",
        "u[1,2]",
    ];
    assert_eq!(names, [&["n"][..], &arrays, &["s"]].concat());
    assert_eq!(d.variable("x[2]").unwrap().start, Some(Value::Real(2.0)));
    assert_eq!(d.variable("u[1,2]").unwrap().start, Some(Value::Real(0.5)));
    assert_eq!(
        d.variable("s").unwrap().start,
        Some(Value::String("hello".into()))
    );
    assert_eq!(d.variable("der(x[3])").unwrap().derivative, Some(7));
    assert!(
        d.co_simulation
            .as_ref()
            .unwrap()
            .provides_directional_derivative
    );
    // clocks have no place
    assert_eq!(d.outputs[0].dependencies, Some(vec![8]));
    assert_eq!(found_in(DESCRIPTION_3), Vec::<String>::new());
}

#[test]
fn defects_of_fmi3_are_found() {
    for (sound, defect, said) in [
        (
            r#"valueReference="8""#,
            r#"valueReference="4""#,
            "a value reference of its own",
        ),
        (r#" start="1 2 3""#, "", "a start value"),
        (
            r#"dependencies="3 9""#,
            r#"dependencies="3 77""#,
            "dependencies in 1",
        ),
        (
            r#"<Output valueReference="4" dependencies="3 9" dependenciesKind="dependent dependent"/>"#,
            "",
            "<Outputs>",
        ),
        (
            r#"<InitialUnknown valueReference="5"/>"#,
            "",
            "<InitialUnknowns>",
        ),
        (
            r#"causality="input" start="0.5""#,
            r#"causality="input" initial="exact" start="0.5""#,
            "no `initial`",
        ),
        (
            r#"<Unit name="m">"#,
            r#"<Unit name="km">"#,
            "a unit of <UnitDefinitions>",
        ),
        (
            r#"start="1 2 3""#,
            r#"start="1 -2 3""#,
            "a start value in 0",
        ),
        (
            r#"<Dimension valueReference="7"/>"#,
            r#"<Dimension valueReference="70"/>"#,
            "dimensions that are known",
        ),
        (r#"fmiVersion="3.0""#, r#"fmiVersion="3""#, "or 3.0"),
        (r#"modelName="m""#, r#"modelName="""#, "a name"),
    ] {
        assert!(DESCRIPTION_3.contains(sound), "{sound}");
        let found = found_in(&DESCRIPTION_3.replacen(sound, defect, 2));
        assert!(
            found.iter().any(|f| f.contains(said)),
            "{sound} → {defect}: {found:#?}"
        );
    }
}
