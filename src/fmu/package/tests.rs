use super::*;
use std::io::Read;

fn model(kind: &str) -> TrainedModel {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/models/{kind}.json"));
    TrainedModel::from_json(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn embedded() -> Vec<Runtime> {
    vec![Runtime::embedded().unwrap()]
}

#[test]
fn archives_are_reproducible_and_complete() {
    let bytes = package(&model("rational"), &embedded()).unwrap();
    assert_eq!(bytes, package(&model("rational"), &embedded()).unwrap());
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    let names: Vec<_> = (0..zip.len())
        .map(|i| zip.by_index(i).unwrap().name().unwrap().into_owned())
        .collect();
    let binary = Runtime::embedded().unwrap().path_in_archive();
    assert_eq!(
        names,
        [
            binary.as_str(),
            "documentation/index.html",
            "documentation/licenses/LICENSE-APACHE.txt",
            "documentation/licenses/LICENSE-MIT.txt",
            "documentation/licenses/THIRD-PARTY.txt",
            "documentation/licenses/license.txt",
            "model.png",
            "modelDescription.xml",
            "resources/model.json",
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
        let resources = Resources::from_bytes(json.as_bytes()).unwrap();
        let page = documentation(&resources, &embedded()).unwrap();
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

#[test]
fn files_are_replaced_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a b.fmu");
    let model = model("rational");
    write_fmu(&path, &model, &embedded(), Overwrite::Refuse).unwrap();
    let first = std::fs::read(&path).unwrap();
    std::fs::write(&path, "mine").unwrap();
    let refusal = write_fmu(&path, &model, &embedded(), Overwrite::Refuse).unwrap_err();
    assert!(refusal.to_string().contains("left as it is"), "{refusal}");
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
    write_fmu(&path, &model, &embedded(), Overwrite::Replace).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let nowhere = folder.path().join("missing").join("a.fmu");
    assert!(write_fmu(&nowhere, &model, &embedded(), Overwrite::Replace).is_err());
}

#[test]
fn impossible_packages_are_refused() {
    let model = model("rational");
    assert!(package(&model, &[]).is_err());
    let twice = [embedded(), embedded()].concat();
    let message = package(&model, &twice).unwrap_err().to_string();
    assert!(
        message.contains("one runtime for each platform"),
        "{message}"
    );
}
