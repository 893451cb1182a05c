//! The rules of the house: who may import whom, how long a file may be.

use crate::source::{Mention, SourceFile};

/// One module and what it may import besides itself and `error`.
pub struct ArrowRow {
    /// The module, from the crate root.
    pub module: &'static str,
    /// Modules with a row of their own, `module+` for one and all that it may use, or longer paths
    /// (`module::Name`, with `*` for any ending).
    pub may_use: &'static [&'static str],
    /// Only types may be imported, no functions.
    pub types_only: bool,
}

const fn row(module: &'static str, may_use: &'static [&'static str]) -> ArrowRow {
    ArrowRow {
        module,
        may_use,
        types_only: false,
    }
}

/// Direction of all imports. A module without a row is refused: write down what it may use.
pub const ARROWS: &[ArrowRow] = &[
    row("error", &[]),
    row("threads", &[]),
    row("numbered", &[]),
    row("json", &[]),
    row("units", &[]),
    row("state_space", &[]),
    row("signal", &[]),
    row("section", &["units"]),
    row("aerodynamics", &["units", "section", "state_space"]),
    row("bridge", &["aerodynamics+"]),
    row("aeroelastic", &["aerodynamics+"]),
    row("flutter", &["aeroelastic+", "bridge", "threads"]),
    row("trained_model", &["units", "section", "aerodynamics"]),
    row(
        "plausibility",
        &["aerodynamics+", "bridge", "trained_model"],
    ),
    row("files", &["aerodynamics+", "bridge", "plausibility"]),
    row(
        "wind_tunnel",
        &[
            "units",
            "section",
            "aerodynamics",
            "signal",
            "files",
            "plausibility",
        ],
    ),
    row(
        "identification",
        &[
            "units",
            "section",
            "state_space",
            "aerodynamics",
            "signal",
            "wind_tunnel::Record*",
            "wind_tunnel::Segment",
            "numbered",
            // what a fit returns
            "trained_model::Model",
            // what its account of constraints says of an onset, once the section is known
            "flutter::MovedOnset",
        ],
    ),
    row(
        "comparison",
        &["signal", "identification+", "wind_tunnel+", "files"],
    ),
    row("response", &["aeroelastic+"]),
    row(
        "buffeting",
        &["flutter+", "response+", "signal", "numbered"],
    ),
    row("live", &["flutter+", "trained_model+"]),
    row("verdict", &["flutter+", "plausibility"]),
    row(
        "fmu",
        &["flutter+", "response+", "trained_model+", "verdict+"],
    ),
    row("fmu::fmi2", &["fmu"]),
    // a second shell over the guard of the first
    row("fmu::fmi3", &["fmu", "fmu::fmi2"]),
    row(
        "fmu::component",
        &["error", "fmu", "fmu::fmi2", "fmu::fmi3"],
    ),
    row(
        "uncertainty",
        &[
            "flutter+",
            "identification+",
            "wind_tunnel+",
            "trained_model",
            // beside a probability, what the model can say of that speed
            "verdict::Verdict",
        ],
    ),
    row(
        "selection",
        &["flutter+", "identification+", "wind_tunnel+", "comparison"],
    ),
    row("reference", BELOW_STUDY),
    row("study", BELOW_STUDY),
    ArrowRow {
        module: "report",
        may_use: &["study+", "reference+", "bridge"],
        types_only: true,
    },
    row("cli", &["report", "study+", "reference+"]),
    row(
        "prelude",
        &[
            "flutter+",
            "trained_model",
            "files",
            "fmu+",
            "identification+",
            "wind_tunnel+",
            "study",
        ],
    ),
    row("main", &["cli+"]),
];

const BELOW_STUDY: &[&str] = &[
    "fmu+",
    "identification+",
    "wind_tunnel+",
    "comparison",
    "files",
    "buffeting+",
    "uncertainty",
    "selection",
    "verdict",
];

/// Every module may use these.
const FOR_ALL: &[&str] = &["error", "json"];

/// Files are written for about 400 lines; this is where they must be split.
pub const LINES_AT_MOST: usize = 420;

/// Module path of a file: `src/a.rs` is `a`, `src/a/b.rs` is `a::b`, `src/lib.rs` the root. The rooms of the inner crates stand
/// beside those of `src`, whose root passes them on: `crates/core/src/a.rs` is `a` too.
pub fn module_of(path: &str) -> Vec<String> {
    let inner = path.split_once("src/").map_or(path, |(_, inner)| inner);
    let inner = inner.trim_end_matches(".rs");
    if inner == "lib" {
        return Vec::new();
    }
    let room = room_of_crate(path).unwrap_or_default().iter().copied();
    room.chain(inner.split('/')).map(str::to_owned).collect()
}

/// The room that a whole crate is; none where a crate has several.
fn room_of_crate(path: &str) -> Option<&'static [&'static str]> {
    let crates: [(&str, &[&str]); 4] = [
        ("crates/component/", &["fmu", "component"]),
        ("crates/fmu-host/", &["fmu", "importer"]),
        ("crates/live/", &["live"]),
        ("crates/unit/", &["fmu"]),
    ];
    let found = crates.iter().find(|(start, _)| path.starts_with(start));
    found.map(|(_, room)| *room)
}

/// What a file mentions, by the paths that the root package has for it. In a crate that is one room, `crate::a` is a part of that
/// room, unless it is the name of another.
pub fn mentions(path: &str, source: &SourceFile) -> Vec<Mention> {
    let mut found = source.mentions(&module_of(path));
    let Some(room) = room_of_crate(path) else {
        return found;
    };
    for mention in &mut found {
        let Some(first) = mention.path.first() else {
            continue;
        };
        let is_room = ARROWS.iter().any(|row| row.module == first);
        if first.starts_with(char::is_uppercase) || is_room {
            continue;
        }
        // what the importer has of the unit
        let of_the_unit = ["location", "standard"].contains(&first.as_str());
        let room = if of_the_unit { &room[..1] } else { room };
        let room = room.iter().map(|name| (*name).to_owned());
        mention.path.splice(0..0, room);
    }
    found
}

/// All breaches in one file of `src` that is not test code. `path` is relative to the package, with `/`.
pub fn breaches(path: &str, source: &SourceFile) -> Vec<String> {
    let module = module_of(path);
    // the root declares the modules and re-exports; it is no module of the house
    if module.is_empty() {
        return Vec::new();
    }
    let Some(own) = row_of(&module) else {
        return vec![format!(
            "{path}: no row for this module in tests/architecture/rules.rs"
        )];
    };
    mentions(path, source)
        .into_iter()
        .filter_map(|mention| {
            let reason = refusal(own, &mention.path)?;
            let target = mention.path.join("::");
            Some(format!("{path}:{}: `{target}` {reason}", mention.line))
        })
        .collect()
}

/// Why a module may not use a path; `None` when it may.
fn refusal(own: &ArrowRow, target: &[String]) -> Option<String> {
    // `crate::Error`, `crate::Result`: re-exports of `error` at the root
    let at_root = target
        .first()
        .is_none_or(|name| name.starts_with(char::is_uppercase));
    if at_root {
        return None;
    }
    let Some(theirs) = row_of(target) else {
        return Some("is a module without a row in tests/architecture/rules.rs".into());
    };
    if theirs.module == own.module || FOR_ALL.contains(&theirs.module) {
        return None;
    }
    let allowed = permits(own, theirs, &target.join("::"));
    if !allowed {
        return Some(format!("may not be used by `{}`", own.module));
    }
    let is_type = target
        .iter()
        .any(|name| name.starts_with(char::is_uppercase));
    (own.types_only && !is_type).then(|| format!("is no type: `{}` may use only types", own.module))
}

/// Whether the list of `own` names the module `theirs`, or the path in it.
fn permits(own: &ArrowRow, theirs: &ArrowRow, path: &str) -> bool {
    own.may_use.iter().any(|entry| {
        if let Some(start) = entry.strip_suffix('*') {
            return path.starts_with(start);
        }
        let Some(module) = entry.strip_suffix('+') else {
            let inside = path.strip_prefix(entry);
            let inside = inside.is_some_and(|rest| rest.is_empty() || rest.starts_with("::"));
            return *entry == theirs.module || inside && entry.contains("::");
        };
        let row = ARROWS.iter().find(|row| row.module == module);
        module == theirs.module || row.is_some_and(|row| permits(row, theirs, path))
    })
}

/// The row with the longest module path that holds `path`.
fn row_of(path: &[String]) -> Option<&'static ArrowRow> {
    let path = path.join("::");
    let holds = |module: &str| {
        path.strip_prefix(module)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
    };
    ARROWS
        .iter()
        .filter(|row| holds(row.module))
        .max_by_key(|row| row.module.len())
}
