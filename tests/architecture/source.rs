//! A source file as the paths in it: comments and test code left out, use trees spread out, imported names followed.

use std::collections::BTreeMap;
use syn::parse::ParseStream;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ImplItem, Item, ItemMod, ItemUse, Macro, Meta, Path, UseTree};

/// A source file.
#[derive(Default)]
pub struct SourceFile {
    /// Modules that stand in files of their own: `mod name;`.
    children: Vec<String>,
    /// Those of them that are compiled for tests only.
    pub test_files: Vec<String>,
    written: Vec<QuotedName>,
    /// Names of the modules around what is being read, within the file.
    inside: Vec<String>,
}

/// A path as it is written.
struct QuotedName {
    inside: Vec<String>,
    segments: Vec<String>,
    /// What a `use` calls it here; none where the path is used on the spot.
    name: Option<String>,
    is_public: bool,
    line: usize,
}

/// A path to a module or item of this crate, from the crate root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mention {
    /// Segments after `crate`.
    pub path: Vec<String>,
    /// What a `use` calls it here; none where the path is used on the spot.
    pub name: Option<String>,
    /// Whether it is passed on: `pub use`.
    pub is_public: bool,
    /// Line in the file, from 1.
    pub line: usize,
}

impl SourceFile {
    /// Reads a file.
    pub fn new(text: &str) -> Self {
        let file = syn::parse_file(text).expect("Rust");
        let mut source = Self::default();
        if !are_for_tests(&file.attrs) {
            source.visit_file(&file);
        }
        source
    }

    /// Every path that starts with `crate`, `aerodeck`, `super`, `self`, a module declared here or an imported name.
    pub fn mentions(&self, module: &[String]) -> Vec<Mention> {
        let own = self.written.iter().filter_map(|written| {
            let path = written.absolute(module, &self.children)?;
            Some(written.mention(path))
        });
        let mut found: Vec<Mention> = own.collect();
        let imports: BTreeMap<&str, &[String]> = found
            .iter()
            .filter_map(|m| Some((m.name.as_deref()?, &m.path[..])))
            .collect();
        let on_the_spot = self.written.iter().filter(|w| w.name.is_none());
        let through_imports = on_the_spot.filter_map(|written| {
            let import = imports.get(written.segments[0].as_str())?;
            Some(written.mention([import, &written.segments[1..]].concat()))
        });
        let through_imports: Vec<Mention> = through_imports.collect();
        found.extend(through_imports);
        found
    }

    fn write(&mut self, segments: Vec<String>, line: usize) {
        self.written.push(QuotedName {
            inside: self.inside.clone(),
            segments,
            name: None,
            is_public: false,
            line,
        });
    }

    /// Adds every leaf of a use tree.
    fn spread(&mut self, tree: &UseTree, mut path: Vec<String>, is_public: bool) {
        let (last, name) = match tree {
            UseTree::Path(onward) => {
                path.push(onward.ident.to_string());
                return self.spread(&onward.tree, path, is_public);
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.spread(tree, path.clone(), is_public);
                }
                return;
            }
            UseTree::Name(leaf) => (leaf.ident.to_string(), leaf.ident.to_string()),
            UseTree::Rename(leaf) => (leaf.ident.to_string(), leaf.rename.to_string()),
            UseTree::Glob(_) => ("*".to_owned(), "*".to_owned()),
        };
        let of_module = last == "self";
        let name = if of_module && name == last {
            path.last().cloned().unwrap_or_default()
        } else {
            name
        };
        path.extend((!of_module).then_some(last));
        self.write(path, tree.span().start().line);
        if let Some(written) = self.written.last_mut() {
            written.name = Some(name);
            written.is_public = is_public;
        }
    }
}

impl QuotedName {
    /// The path from the root of the crate; none where it does not start in it.
    fn absolute(&self, module: &[String], children: &[String]) -> Option<Vec<String>> {
        let mut base = [module, &self.inside].concat();
        let mut rest = &self.segments[1..];
        match self.segments[0].as_str() {
            "crate" | "aerodeck" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                while let Some(("super", onward)) =
                    rest.split_first().map(|(first, r)| (first.as_str(), r))
                {
                    base.pop();
                    rest = onward;
                }
            }
            name if children.iter().any(|child| child == name) => rest = &self.segments,
            _ => return None,
        }
        Some([&base, rest].concat())
    }

    fn mention(&self, path: Vec<String>) -> Mention {
        Mention {
            path,
            name: self.name.clone(),
            is_public: self.is_public,
            line: self.line,
        }
    }
}

impl<'ast> Visit<'ast> for SourceFile {
    fn visit_item(&mut self, item: &'ast Item) {
        if !are_for_tests(attributes(item)) {
            return visit::visit_item(self, item);
        }
        if let Item::Mod(ItemMod {
            content: None,
            ident,
            ..
        }) = item
        {
            self.test_files.push(ident.to_string());
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let is_for_tests = matches!(item, ImplItem::Fn(method) if are_for_tests(&method.attrs));
        if !is_for_tests {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if module.content.is_none() {
            self.children.push(module.ident.to_string());
        }
        self.inside.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.inside.pop();
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let is_public = !matches!(item.vis, syn::Visibility::Inherited);
        self.spread(&item.tree, Vec::new(), is_public);
    }

    fn visit_path(&mut self, path: &'ast Path) {
        if path.segments.len() > 1 && path.leading_colon.is_none() {
            let segments = path.segments.iter().map(|s| s.ident.to_string());
            self.write(segments.collect(), path.span().start().line);
        }
        visit::visit_path(self, path);
    }

    /// The arguments, as far as they are expressions.
    fn visit_macro(&mut self, call: &'ast Macro) {
        let mut arguments: Vec<Expr> = Vec::new();
        let read = |input: ParseStream<'_>| {
            while !input.is_empty() {
                arguments.push(input.parse()?);
                input.parse::<Option<proc_macro2::Punct>>()?;
            }
            Ok(())
        };
        // what follows an argument that is none is left out
        let _ = call.parse_body_with(read);
        for argument in arguments {
            SourceFile::visit_expr(self, &argument);
        }
    }

    /// A path in an attribute stands in a string.
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        let Meta::List(list) = &attribute.meta else {
            return;
        };
        let text = list.tokens.to_string();
        for path in text.split('"').filter(|part| part.starts_with("crate::")) {
            let segments = path.split("::").map(str::to_owned).collect();
            self.write(segments, attribute.span().start().line);
        }
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Whether an item is there for tests alone.
pub fn is_for_tests(item: &Item) -> bool {
    are_for_tests(attributes(item))
}

/// Whether `cfg(test)` is among them; `all(test, …)` counts, `not(test)` does not.
fn are_for_tests(attributes: &[Attribute]) -> bool {
    let is_for_tests = |attribute: &Attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let words = list.tokens.to_string();
            let mut words = words.split(|c: char| !c.is_alphanumeric());
            words.clone().any(|w| w == "test") && words.all(|w| w != "not")
        }
        _ => false,
    };
    attributes.iter().any(is_for_tests)
}
