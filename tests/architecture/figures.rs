//! How large the house is: lines, types, names, tuple parameters. Printed by `cargo test --test architecture figures -- --nocapture`;
//! each has a ceiling that is lowered when the tree falls below it.

use crate::{SOURCES, rust_files, test_modules};
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::{self, Visit};
use syn::{FnArg, ImplItemFn, Item, Pat, Signature};

/// What is counted, of code that is no test.
#[derive(Debug, Default)]
struct Figures {
    /// Lines of code with neither comment nor space alone, by the crate they stand in.
    lines: BTreeMap<String, usize>,
    /// Names of structs, enums, unions and traits, and how many types have each.
    types: BTreeMap<String, usize>,
    /// Functions of which a parameter is taken apart as a tuple, or is one.
    with_tuples: Vec<String>,
    /// Whether tests count.
    with_tests: bool,
}

impl Figures {
    fn type_count(&self) -> usize {
        self.types.values().sum()
    }

    fn names_used_twice(&self) -> usize {
        self.types.values().filter(|count| **count > 1).count()
    }

    fn line_count(&self) -> usize {
        self.lines.values().sum()
    }

    fn signature(&mut self, signature: &Signature) {
        let is_tuple = |argument: &FnArg| match argument {
            FnArg::Typed(typed) => {
                let ty = match &*typed.ty {
                    syn::Type::Reference(reference) => &*reference.elem,
                    other => other,
                };
                matches!(&*typed.pat, Pat::Tuple(_))
                    || matches!(ty, syn::Type::Tuple(tuple) if !tuple.elems.is_empty())
            }
            FnArg::Receiver(_) => false,
        };
        if signature.inputs.iter().any(is_tuple) {
            self.with_tuples.push(signature.ident.to_string());
        }
    }

    fn name(&mut self, name: &syn::Ident) {
        *self.types.entry(name.to_string()).or_default() += 1;
    }
}

impl<'ast> Visit<'ast> for Figures {
    fn visit_item(&mut self, item: &'ast Item) {
        if !self.with_tests && crate::source::is_for_tests(item) {
            return;
        }
        match item {
            Item::Struct(item) => self.name(&item.ident),
            Item::Enum(item) => self.name(&item.ident),
            Item::Union(item) => self.name(&item.ident),
            Item::Trait(item) => self.name(&item.ident),
            Item::Fn(item) => self.signature(&item.sig),
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item_fn(&mut self, method: &'ast ImplItemFn) {
        self.signature(&method.sig);
        visit::visit_impl_item_fn(self, method);
    }
}

/// Lines of a file that are code, without what stands below a module of tests at its end.
fn code_lines(text: &str) -> usize {
    let own = text.split("#[cfg(test)]\nmod tests {").next();
    let lines = own.unwrap_or_default().lines().map(str::trim);
    lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .count()
}

fn figures() -> Figures {
    let mut found = Figures::default();
    for directory in SOURCES {
        let files: Vec<(String, String)> = rust_files(directory);
        let tests: BTreeSet<String> = files
            .iter()
            .flat_map(|(path, text)| test_modules(path, &crate::source::SourceFile::new(text)))
            .collect();
        for (path, text) in &files {
            let stem = path.trim_end_matches(".rs");
            if tests
                .iter()
                .any(|t| stem == t || stem.starts_with(&format!("{t}/")))
            {
                continue;
            }
            *found.lines.entry((*directory).to_owned()).or_default() += code_lines(text);
            found.visit_file(&syn::parse_file(text).unwrap());
        }
    }
    found
}

/// The same names and signatures of every Rust file, tests, benches and the Python package included.
fn of_every_file() -> Figures {
    let mut found = Figures {
        with_tests: true,
        ..Figures::default()
    };
    let beside = ["tests", "benches", "examples", "python/src", "fmu_build"];
    for directory in SOURCES.iter().copied().chain(beside) {
        for (_, text) in rust_files(directory) {
            found.visit_file(&syn::parse_file(&text).unwrap());
        }
    }
    found
}

/// Figure by figure: what it is now, and the ceiling.
#[test]
fn the_house_does_not_grow() {
    let (found, whole) = (figures(), of_every_file());
    let core = found.lines["crates/core/src"];
    let table = [
        ("code lines", found.line_count(), 81_670),
        ("code lines of the core", core, 12_971),
        ("types", found.type_count(), 814),
        ("names of several types", found.names_used_twice(), 0),
        (
            "functions with a tuple parameter",
            found.with_tuples.len(),
            0,
        ),
        (
            "names of several types, with tests and Python",
            whole.names_used_twice(),
            8,
        ),
        (
            "functions with a tuple parameter, with tests and Python",
            whole.with_tuples.len(),
            0,
        ),
    ];
    for (directory, lines) in &found.lines {
        println!("{lines:>7}  code lines in {directory}");
    }
    for (what, count, ceiling) in table {
        println!("{count:>7}  {what} (at most {ceiling})");
    }
    let several = whole.types.iter().filter(|(_, count)| **count > 1);
    let names: Vec<String> = several.map(|(n, count)| format!("{n} {count}")).collect();
    println!("names of several types: {}", names.join(", "));
    println!("tuple parameters: {}", whole.with_tuples.join(", "));
    for (what, count, ceiling) in table {
        assert!(count <= ceiling, "{count} {what}, at most {ceiling}");
    }
}

/// Names that items pass on to users, and whether their documentation has an example.
#[derive(Default)]
struct Examples(BTreeMap<String, bool>);

impl<'ast> Visit<'ast> for Examples {
    fn visit_item(&mut self, item: &'ast Item) {
        let (name, attributes) = match item {
            Item::Struct(item) => (&item.ident, &item.attrs),
            Item::Enum(item) => (&item.ident, &item.attrs),
            Item::Trait(item) => (&item.ident, &item.attrs),
            Item::Type(item) => (&item.ident, &item.attrs),
            Item::Fn(item) => (&item.sig.ident, &item.attrs),
            _ => return visit::visit_item(self, item),
        };
        let is_example = |a: &syn::Attribute| match &a.meta {
            syn::Meta::NameValue(doc) => matches!(&doc.value, syn::Expr::Lit(text)
                if matches!(&text.lit, syn::Lit::Str(line) if line.value().contains("```"))),
            _ => false,
        };
        let has_one = attributes.iter().any(is_example);
        *self.0.entry(name.to_string()).or_default() |= has_one;
    }
}

fn leaves(tree: &syn::UseTree, names: &mut Vec<String>) {
    match tree {
        syn::UseTree::Path(path) => leaves(&path.tree, names),
        syn::UseTree::Group(group) => group.items.iter().for_each(|t| leaves(t, names)),
        syn::UseTree::Name(name) => names.push(name.ident.to_string()),
        _ => panic!("a rename or a glob in the prelude"),
    }
}

#[test]
fn the_prelude_is_thirty_names_with_examples() {
    let prelude = include_str!("../../src/prelude.rs");
    let mut names = Vec::new();
    for item in syn::parse_file(prelude).unwrap().items {
        match item {
            Item::Use(item) => leaves(&item.tree, &mut names),
            _ => panic!("something else than `use` in the prelude"),
        }
    }
    assert_eq!(names.len(), 30, "{names:?}");
    let mut examples = Examples::default();
    for directory in SOURCES {
        for (_, text) in rust_files(directory) {
            examples.visit_file(&syn::parse_file(&text).unwrap());
        }
    }
    let without: Vec<&String> = names.iter().filter(|n| !examples.0[*n]).collect();
    assert!(without.is_empty(), "no example: {without:?}");
}
