use super::*;
use crate::trained_model::Model;
use std::io::{Cursor, Read};
use zip::CompressionMethod;

fn model(kind: &str) -> TrainedModel {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/models/{kind}.json"));
    TrainedModel::from_json(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn embedded() -> Vec<Runtime> {
    vec![Runtime::embedded().unwrap()]
}

#[test]
fn archives_are_reproducible_and_complete() {
    let bytes = package(&model("rational"), &embedded(), Export::default()).unwrap();
    assert_eq!(
        bytes,
        package(&model("rational"), &embedded(), Export::default()).unwrap()
    );
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    let names: Vec<_> = (0..zip.len())
        .map(|i| zip.by_index(i).unwrap().name().unwrap().into_owned())
        .collect();
    let binary = Runtime::embedded()
        .unwrap()
        .path_in_archive(FmiVersion::Two);
    assert_eq!(
        names,
        [
            binary.as_str(),
            "documentation/fmi-ls-ref.txt",
            "documentation/index.html",
            "documentation/licenses/LICENSE-APACHE.txt",
            "documentation/licenses/LICENSE-MIT.txt",
            "documentation/licenses/THIRD-PARTY.txt",
            "documentation/licenses/license.txt",
            "extra/org.fmi-standard.fmi-ls-ref/above_in.csv",
            "extra/org.fmi-standard.fmi-ls-ref/above_out.csv",
            "extra/org.fmi-standard.fmi-ls-ref/as_exported.ssv",
            "extra/org.fmi-standard.fmi-ls-ref/at_in.csv",
            "extra/org.fmi-standard.fmi-ls-ref/at_out.csv",
            "extra/org.fmi-standard.fmi-ls-ref/below_in.csv",
            "extra/org.fmi-standard.fmi-ls-ref/below_out.csv",
            "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml",
            "extra/org.fmi-standard.fmi-ls-ref/replay.py",
            "extra/org.fmi-standard.fmi-ls-ref/smoke_test.exp",
            "extra/org.fmi-standard.fmi-ls-ref/smoke_test_in.csv",
            "extra/org.fmi-standard.fmi-ls-ref/smoke_test_out.csv",
            "extra/org.fmi-standard.fmi-ls-ref/validation.exp",
            "model.png",
            "modelDescription.xml",
            "resources/model.json",
            "terminalsAndIcons/terminalsAndIcons.xml",
        ]
    );
    for i in 0..zip.len() {
        let entry = zip.by_index(i).unwrap();
        assert_eq!(entry.compression(), CompressionMethod::Deflated);
        assert!(entry.version_needed() <= 20, "{}", entry.version_needed());
    }
    let mut json = String::new();
    let mut entry = zip.by_name("resources/model.json").unwrap();
    entry.read_to_string(&mut json).unwrap();
    assert_eq!(TrainedModel::from_json(&json).unwrap(), model("rational"));
}

#[test]
fn the_page_names_everything_and_loads_nothing() {
    for kind in ["rational", "continuous_laguerre", "discrete_laguerre"] {
        let json = model(kind).to_json().unwrap();
        let resources = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap();
        let xml = model_description(&resources, false, &Label::default()).unwrap();
        let xml = Element::parse(&xml).unwrap();
        let page = documentation::documentation(&resources, &embedded(), &xml, None).unwrap();
        for v in resources.table.variables() {
            assert!(
                page.contains(&format!("<code>{}</code>", v.name)),
                "{}",
                v.name
            );
        }
        for foreign in ["http:", "https:", "src=", "href=", "@import"] {
            assert!(!page.contains(foreign), "{foreign} in the page of {kind}");
        }
        assert!(page.contains("Flutter onset "));
        assert_eq!(page.contains("is held</b>"), kind == "discrete_laguerre");
    }
}

/// Version, names, types and sizes on the page are those of the archive.
#[test]
fn the_page_of_an_archive_describes_that_archive() {
    let mut force = ForceOptions::single(31.0);
    force.named_strips = true;
    force.strips = vec![force.strips[0].clone(); 3];
    for version in [FmiVersion::Two, FmiVersion::Three] {
        let export = Export {
            force: Some(force.clone()),
            version,
            without_reference_runs: true,
            ..Export::default()
        };
        let bytes = package(&model("rational"), &embedded(), export).unwrap();
        let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
        let [page, xml] = ["documentation/index.html", "modelDescription.xml"].map(|name| {
            let mut text = String::new();
            zip.by_name(name)
                .unwrap()
                .read_to_string(&mut text)
                .unwrap();
            text
        });
        let xml = Element::parse(&xml).unwrap();
        let fmi = xml.attribute("fmiVersion").unwrap();
        let kinds = format!("FMI {fmi} co-simulation and model exchange");
        assert!(page.contains(&kinds), "{page}");
        let is_three = version == FmiVersion::Three;
        for v in &xml.child("ModelVariables").unwrap().children {
            let name = v.attribute("name").unwrap();
            let further = ["strip[2]", "strip[3]"].iter().any(|s| name.contains(s));
            let shown = page.contains(&format!("<code>{name}</code>"));
            assert_eq!(shown, !further, "{name}");
        }
        let heave = "<code>heave</code></td><td>Float64[strips]</td>";
        assert_eq!(page.contains(heave), is_three);
        let type_of_two = page.contains("<td>Real</td>") || page.contains("input derivatives");
        assert_eq!(type_of_two, !is_three);
    }
}

fn page_of(model: &TrainedModel, export: Export) -> String {
    let bytes = package(model, &embedded(), export).unwrap();
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut page = String::new();
    let mut entry = zip.by_name("documentation/index.html").unwrap();
    entry.read_to_string(&mut page).unwrap();
    page
}

#[test]
fn the_page_says_what_gusts_do() {
    use crate::aerodynamics::RationalAdmittance;
    let model = model("rational");
    let table = Some("flat plate");
    let dofs = model.section.dofs();
    let sears = Some(RationalAdmittance::Sears);
    let gusts = crate::files::coefficients::gust_force(table, sears, &dofs).unwrap();
    for force in [None, Some(ForceOptions::single(31.0))] {
        for gusts in [None, gusts.clone()] {
            let act = gusts.is_some();
            let export = Export {
                force: force.clone(),
                gusts,
                without_reference_runs: true,
                ..Export::default()
            };
            let page = page_of(&model, export);
            assert_eq!(page.contains("smooth wind"), !act);
            let said = page.contains("static coefficients") && page.contains("admittance of Sears");
            assert_eq!(said, act, "{page}");
        }
    }
}

/// An array whose size is no structural parameter states its number.
#[test]
fn sizes_of_arrays_of_nodes_are_numbers_on_the_page() {
    let mut force = ForceOptions::single(31.0);
    force.named_strips = true;
    force.strips = vec![force.strips[0].clone(); 2];
    force.nodes = vec![4, 7];
    let export = Export {
        force: Some(force),
        version: FmiVersion::Three,
        without_reference_runs: true,
        ..Export::default()
    };
    let page = page_of(&model("rational"), export);
    let heave = "<code>heave</code></td><td>Float64[2]</td>";
    assert!(page.contains(heave), "{page}");
}

/// Forces of turned signs are doubted on the page of a unit that has no section as well.
#[test]
fn the_page_of_forces_says_what_looks_wrong_in_them() {
    let mut odd = model("rational");
    let Model::Rational(forces) = &mut odd.model else {
        panic!("another model")
    };
    let terms = [&mut forces.a1, &mut forces.a2, &mut forces.a3];
    let terms = terms.into_iter().chain(&mut forces.lag_terms);
    terms.for_each(|m| *m *= -1.0);
    for (model, wrong) in [(model("rational"), false), (odd, true)] {
        let export = Export {
            force: Some(ForceOptions::single(31.0)),
            without_reference_runs: true,
            allow_unstable: true,
            ..Export::default()
        };
        let page = page_of(&model, export);
        assert_eq!(page.contains("What looks wrong in the forces"), wrong);
        assert_eq!(page.contains("sign of forces and motion"), wrong, "{page}");
    }
}

#[test]
fn files_are_replaced_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a b.fmu");
    let model = model("rational");
    write_fmu(&path, &model, &embedded(), false, Export::default()).unwrap();
    let first = std::fs::read(&path).unwrap();
    std::fs::write(&path, "mine").unwrap();
    let refusal = write_fmu(&path, &model, &embedded(), false, Export::default()).unwrap_err();
    assert!(refusal.to_string().contains("left as it is"), "{refusal}");
    let replace = || write_fmu(&path, &model, &embedded(), true, Export::default());
    // an archive is replaced on request, a model or a table never
    let refusal = replace().unwrap_err().to_string();
    assert!(
        refusal.contains("no file there yet, or an archive"),
        "{refusal}"
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
    std::fs::write(&path, &first).unwrap();
    replace().unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let nowhere = folder.path().join("missing").join("a.fmu");
    assert!(write_fmu(&nowhere, &model, &embedded(), true, Export::default()).is_err());
}

#[test]
fn impossible_packages_are_refused() {
    let model = model("rational");
    assert!(package(&model, &[], Export::default()).is_err());
    let twice = [embedded(), embedded()].concat();
    let message = package(&model, &twice, Export::default())
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("one runtime for each platform"),
        "{message}"
    );
}

/// The part `c p²/(p + d)` on heave feeds energy in at reduced frequencies above the tested ones.
pub(crate) fn growing_model() -> TrainedModel {
    let (c, d) = (20.0, 6.0);
    let mut growing = model("rational");
    let crate::trained_model::Model::Rational(rational) = &mut growing.model else {
        panic!("no rational model");
    };
    rational.a2[(0, 0)] += c;
    let mut lag = rational.a2.clone() * 0.0;
    lag[(0, 0)] = -c * d;
    rational.lag_terms.push(lag);
    let crate::aerodynamics::Lags::Shared(lags) = &mut rational.lags else {
        panic!("no shared lags");
    };
    lags.push(d);
    growing
}

#[test]
fn a_model_that_grows_where_nothing_was_tested_is_exported_only_on_request() {
    let model = growing_model();
    let refusal = package(&model, &embedded(), Export::default()).unwrap_err();
    let refusal = refusal.to_string();
    for words in ["is not exported", "grows from", "m/s", "were not tested"] {
        assert!(refusal.contains(words), "`{words}` is not in: {refusal}");
    }
    let bytes = package(
        &model,
        &embedded(),
        Export {
            allow_unstable: true,
            ..Export::default()
        },
    )
    .unwrap();
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    let mut page = String::new();
    let mut entry = zip.by_name("documentation/index.html").unwrap();
    entry.read_to_string(&mut page).unwrap();
    assert!(page.contains("grows where it should not"), "{page}");
}

#[test]
fn an_instance_says_where_it_grows_when_initialised_and_after_its_parameters_have_changed() {
    use crate::fmu::instance::Instance;
    let resources = |model: &TrainedModel| {
        Resources::from_bytes(model.to_json().unwrap().as_bytes(), [None; 3]).unwrap()
    };
    let growth = |notices: Vec<String>| {
        let about = |n: &String| n.contains("grows where it should not");
        notices.iter().filter(|n| about(n)).count()
    };
    let initialised = |model: &TrainedModel| {
        let mut instance = Instance::new(resources(model)).unwrap();
        // parameters may still be set
        assert_eq!(growth(instance.take_notices()), 0);
        instance.set_up_experiment(0.0, None).unwrap();
        instance.enter_initialization();
        instance.exit_initialization().unwrap();
        instance
    };
    let mut bad = initialised(&growing_model());
    assert_eq!(growth(bad.take_notices()), 1);
    bad.do_step(0.0, 0.01).unwrap();
    // said already
    assert_eq!(growth(bad.take_notices()), 0);
    let stable = bad.table().find_name("stable_below_onset").unwrap() as u32;
    assert!(!bad.boolean(stable).unwrap());
    let damping = |instance: &Instance| {
        let variables = instance.table().variables();
        let is_damping = |name: &str| name.contains("heave") && name.contains("damping");
        let place = variables.iter().position(|v| is_damping(&v.name)).unwrap();
        [u32::try_from(place).unwrap()]
    };
    // enough structural damping beats the made-up energy; taking it away brings the growth back
    for (ratio, said) in [(0.5, 0), (0.003, 1)] {
        let reference = damping(&bad);
        bad.set_reals(&reference, &[ratio]).unwrap();
        bad.do_step(bad.time_s(), 0.01).unwrap();
        assert_eq!(growth(bad.take_notices()), said, "{ratio}");
        bad.do_step(bad.time_s(), 0.01).unwrap();
        assert_eq!(growth(bad.take_notices()), 0, "{ratio}");
    }
    let mut good = initialised(&model("rational"));
    assert_eq!(growth(good.take_notices()), 0);
}

/// Names of labels come from anywhere; the description stays XML, and says what the runtime answers. Those of models are refused.
#[test]
fn control_characters_stay_out_of_the_description() {
    let model = model("rational");
    let mut named = model.clone();
    named.name = "a \u{1b}[31mdeck\u{0}".into();
    assert!(named.to_json().is_err());
    let label = Label {
        name: Some("na\u{7}me".into()),
        author: Some("au\u{1b}thor".into()),
        copyright: Some("\u{2}".into()),
        generated: None,
    };
    let json = model.to_json().unwrap();
    let resources = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap();
    let three = description_fmi3::model_description(&resources, &label).unwrap();
    let two = model_description(&resources, false, &label).unwrap();
    for text in [&two, &three] {
        let root = Element::parse(text).unwrap();
        assert_eq!(root.attribute("modelName"), Some("name"));
        assert_eq!(root.attribute("author"), Some("author"));
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'));
    }
}

#[test]
fn a_report_enters_an_archive_and_its_manifest() {
    let bytes = package(&model("rational"), &embedded(), Export::default()).unwrap();
    let with = archive_file::with_report(&bytes, "<html>of the study</html>").unwrap();
    let mut zip = zip::ZipArchive::new(Cursor::new(&with)).unwrap();
    let mut text = |name: &str| {
        let mut text = String::new();
        let mut entry = zip.by_name(name).unwrap();
        entry.read_to_string(&mut text).unwrap();
        text
    };
    let folder = "extra/org.fmi-standard.fmi-ls-ref";
    assert!(text(&format!("{folder}/report.html")).contains("of the study"));
    let manifest = text(&format!("{folder}/fmi-ls-manifest.xml"));
    assert!(
        manifest.contains("source=\"report.html\" role=\"report\""),
        "{manifest}"
    );
    let without = Export {
        without_reference_runs: true,
        ..Export::default()
    };
    let bytes = package(&model("rational"), &embedded(), without).unwrap();
    assert_eq!(archive_file::with_report(&bytes, "").unwrap(), bytes);
}
