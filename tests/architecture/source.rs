//! A source file as tokens: comments and test code left out, use trees spread out, paths to our modules found.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::collections::BTreeMap;

/// A source file.
#[derive(Default)]
pub struct Source {
    /// The file, then each `mod name { … }` in it.
    sections: Vec<Section>,
    /// Modules that stand in files of their own: `mod name;`.
    pub children: Vec<String>,
    /// Those of them that are compiled for tests only: their names or `#[path]` files.
    pub test_files: Vec<String>,
}

/// The tokens of one module.
#[derive(Default)]
struct Section {
    /// Names of the modules around it, within the file.
    inside: Vec<String>,
    tokens: Vec<Token>,
}

/// A word, `::`, a sign, a bracket or a literal.
struct Token {
    text: String,
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

impl Source {
    /// Reads a file.
    pub fn new(text: &str) -> Self {
        let mut source = Self::default();
        source.take(text.parse().expect("Rust"), Vec::new());
        source
    }

    /// Reads the tokens of a module.
    fn take(&mut self, stream: TokenStream, inside: Vec<String>) {
        let mut section = Section {
            inside,
            tokens: Vec::new(),
        };
        self.flatten(stream, &mut section);
        self.sections.push(section);
    }

    fn flatten(&mut self, stream: TokenStream, section: &mut Section) {
        let trees: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            if is_for_tests(&trees[at..], "#![") {
                return;
            }
            if is_for_tests(&trees[at..], "#[") {
                let end = at + item_length(&trees[at..]);
                self.test_files.extend(own_file(&trees[at..end]));
                at = end;
                continue;
            }
            match &trees[at..] {
                [
                    TokenTree::Ident(word),
                    TokenTree::Ident(name),
                    TokenTree::Group(body),
                    ..,
                ] if word == "mod" && body.delimiter() == Delimiter::Brace => {
                    let mut inside = section.inside.clone();
                    inside.push(name.to_string());
                    self.take(body.stream(), inside);
                    at += 3;
                    continue;
                }
                [
                    TokenTree::Ident(word),
                    TokenTree::Ident(name),
                    TokenTree::Punct(end),
                    ..,
                ] if word == "mod" && end.as_char() == ';' => {
                    self.children.push(name.to_string());
                }
                _ => {}
            }
            at += self.push(&trees[at..], section);
        }
    }

    /// Adds the first of some trees; how many were taken.
    fn push(&mut self, trees: &[TokenTree], section: &mut Section) -> usize {
        let line = trees[0].span().start().line;
        let mut token = |text: String| section.tokens.push(Token { text, line });
        match &trees[0] {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::None => ("", ""),
                };
                token(open.to_owned());
                self.flatten(group.stream(), section);
                section.tokens.push(Token {
                    text: close.to_owned(),
                    line: group.span_close().start().line,
                });
            }
            TokenTree::Punct(p) if p.as_char() == ':' && p.spacing() == Spacing::Joint => {
                token("::".to_owned());
                return 2;
            }
            // a path in an attribute stands in a string
            TokenTree::Literal(text) if text.to_string().starts_with("\"crate::") => {
                for part in text.to_string().trim_matches('"').split("::") {
                    token(part.to_owned());
                    token("::".to_owned());
                }
                section.tokens.pop();
            }
            other => token(other.to_string()),
        }
        1
    }

    /// Lines at which these tokens stand, written with spaces between them.
    pub fn find(&self, words: &str) -> Vec<usize> {
        let words: Vec<&str> = words.split_whitespace().collect();
        let all = self
            .sections
            .iter()
            .flat_map(|s| s.tokens.windows(words.len()));
        all.filter(|found| {
            found
                .iter()
                .map(|t| t.text.as_str())
                .eq(words.iter().copied())
        })
        .map(|found| found[0].line)
        .collect()
    }

    /// Every path that starts with `crate`, `aerodeck`, `super`, `self`, a module declared here or an imported name.
    pub fn mentions(&self, module: &[String]) -> Vec<Mention> {
        self.sections
            .iter()
            .flat_map(|section| section.mentions(module, &self.children))
            .collect()
    }
}

impl Section {
    fn text(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |t| t.text.as_str())
    }

    fn mentions(&self, module: &[String], children: &[String]) -> Vec<Mention> {
        let mut found = self.paths(module, children);
        found.extend(self.through_imports(&found));
        found
    }

    /// Paths that start with an imported name: `use super::roots;`, then `roots::bisect(…)`.
    fn through_imports(&self, imports: &[Mention]) -> Vec<Mention> {
        let imports: BTreeMap<&str, &Mention> = imports
            .iter()
            .filter_map(|import| Some((import.name.as_deref()?, import)))
            .collect();
        let mut found = Vec::new();
        let mut in_use = false;
        for at in 0..self.tokens.len() {
            in_use = self.text(at) == "use" || in_use && self.text(at) != ";";
            let starts = self.text(at + 1) == "::" && !self.continues(at);
            let import = imports.get(self.text(at)).filter(|_| starts && !in_use);
            let Some(import) = import else { continue };
            let from = found.len();
            self.spread(at + 2, import.path.clone(), &mut found);
            for mention in &mut found[from..] {
                mention.line = self.tokens[at].line;
                mention.name = None;
            }
        }
        found
    }

    /// Whether a path or a call goes on at this token.
    fn continues(&self, at: usize) -> bool {
        at > 0 && matches!(self.text(at - 1), "::" | ".")
    }

    /// Paths that start with `crate`, `aerodeck`, `super`, `self` or a module declared here.
    fn paths(&self, module: &[String], children: &[String]) -> Vec<Mention> {
        let mut found = Vec::new();
        let mut of_use = None;
        for at in 0..self.tokens.len() {
            match self.text(at) {
                "use" => of_use = Some(at > 0 && matches!(self.text(at - 1), "pub" | ")")),
                ";" => of_use = None,
                _ => {}
            }
            if self.text(at + 1) != "::" || self.continues(at) {
                continue;
            }
            let mut base = [module, &self.inside].concat();
            let mut after = at + 2;
            match self.text(at) {
                "crate" | "aerodeck" => base.clear(),
                "self" => {}
                "super" => {
                    base.pop();
                    while self.text(after) == "super" {
                        base.pop();
                        after += 2;
                    }
                }
                name if children.iter().any(|c| c == name) => after = at,
                _ => continue,
            }
            let start = found.len();
            self.spread(after, base, &mut found);
            for mention in &mut found[start..] {
                mention.line = self.tokens[at].line;
                mention.is_public = of_use == Some(true);
                mention.name = mention.name.take().filter(|_| of_use.is_some());
            }
        }
        found
    }

    /// Follows a path or use tree from a token, adding every leaf; returns where it ends.
    fn spread(&self, mut at: usize, mut path: Vec<String>, found: &mut Vec<Mention>) -> usize {
        if self.text(at) == "{" {
            at += 1;
            while !matches!(self.text(at), "}" | "") {
                at = self.spread(at, path.clone(), found);
                at += usize::from(self.text(at) == ",");
            }
            return at + 1;
        }
        if self.text(at) != "self" {
            path.push(self.text(at).to_owned());
        }
        if self.text(at + 1) == "::" && self.text(at + 2) != "<" {
            return self.spread(at + 2, path, found);
        }
        let is_renamed = self.text(at + 1) == "as";
        let end = at + if is_renamed { 2 } else { 0 };
        let name = match self.text(end) {
            "self" => path.last().cloned(),
            name => Some(name.to_owned()),
        };
        found.push(Mention {
            path,
            name,
            is_public: false,
            line: 0,
        });
        end + 1
    }
}

/// Whether `#[cfg(test)]` stands here, or `#![cfg(test)]`; `all(test, …)` counts, `not(test)` does not.
fn is_for_tests(trees: &[TokenTree], start: &str) -> bool {
    let (signs, tail) = trees.split_at(start.len().min(trees.len()) - 1);
    let signs: String = signs.iter().map(ToString::to_string).collect();
    let Some(TokenTree::Group(group)) = tail.first() else {
        return false;
    };
    let words = all_words(group.stream());
    let has = |word: &str| words.iter().any(|w| w == word);
    start.strip_suffix('[') == Some(&signs) && words[0] == "cfg" && has("test") && !has("not")
}

fn all_words(stream: TokenStream) -> Vec<String> {
    let words = |tree: TokenTree| match tree {
        TokenTree::Group(group) => all_words(group.stream()),
        other => vec![other.to_string()],
    };
    stream.into_iter().flat_map(words).collect()
}

/// Trees up to the `;` or the closing brace of an item.
fn item_length(trees: &[TokenTree]) -> usize {
    let is_end = |tree: &TokenTree| match tree {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(p) => p.as_char() == ';',
        _ => false,
    };
    trees
        .iter()
        .position(is_end)
        .map_or(trees.len(), |end| end + 1)
}

/// `mod name;`: the `#[path]` file if one is given, else the name.
fn own_file(item: &[TokenTree]) -> Option<String> {
    let words = all_words(item.iter().cloned().collect());
    let (end, item) = words.split_last()?;
    let [.., word, name] = item else { return None };
    let by_path = words.windows(3).find(|w| w[0] == "path" && w[1] == "=");
    (end == ";" && word == "mod")
        .then(|| by_path.map_or_else(|| name.clone(), |w| w[2].trim_matches('"').to_owned()))
}
