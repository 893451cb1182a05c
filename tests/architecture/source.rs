//! Reading Rust source without a compiler: comments, strings and test code blanked out, paths to our modules found.

/// A source file, in texts of one length: positions mean the same in both.
pub struct Source {
    /// Without comments and test code.
    pub code: Vec<char>,
    /// Without the contents of strings either.
    pub tokens: Vec<char>,
    /// Modules that stand in files of their own and are compiled for tests only: their names or `#[path]` files.
    pub test_files: Vec<String>,
}

/// A path to a module or item of this crate, from the crate root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mention {
    /// Segments after `crate`.
    pub path: Vec<String>,
    /// Line in the file, from 1.
    pub line: usize,
}

impl Source {
    /// Reads a file.
    pub fn new(text: &str) -> Self {
        let (code, tokens) = without_comments(text);
        let mut source = Self {
            code,
            tokens,
            test_files: Vec::new(),
        };
        source.blank_test_code();
        source
    }

    /// Line of a position, from 1.
    pub fn line(&self, at: usize) -> usize {
        1 + self.tokens[..at].iter().filter(|c| **c == '\n').count()
    }

    /// Positions at which `word` stands as a whole word (ends that are no word characters always match).
    pub fn find(&self, word: &str) -> Vec<usize> {
        find_word(&self.tokens, word)
    }

    /// Every `crate::…`, `super::…` and `aerodeck::…`, use trees spread out, strings included (serde attributes).
    pub fn mentions(&self, module: &[String]) -> Vec<Mention> {
        let mut found = Vec::new();
        for at in find_word(&self.code, "crate::") {
            self.spread(at, at + 7, Vec::new(), &mut found);
        }
        for at in find_word(&self.code, "aerodeck::") {
            self.spread(at, at + 10, Vec::new(), &mut found);
        }
        for at in find_word(&self.code, "super::") {
            if self.code[..at].ends_with(&[':', ':']) {
                continue;
            }
            let mut base: Vec<String> = module.to_vec();
            base.extend(self.inline_modules(at));
            let mut after = at;
            while starts_with(&self.code, after, "super::") {
                base.pop();
                after += 7;
            }
            self.spread(at, after, base, &mut found);
        }
        found
    }

    /// Follows a path or use tree from `at`, adding every leaf; returns where it ends.
    fn spread(
        &self,
        start: usize,
        mut at: usize,
        mut prefix: Vec<String>,
        found: &mut Vec<Mention>,
    ) -> usize {
        at = skip_space(&self.code, at);
        if self.code.get(at) == Some(&'{') {
            at += 1;
            loop {
                at = skip_space(&self.code, at);
                match self.code.get(at) {
                    Some('}') => return at + 1,
                    Some(',') => at += 1,
                    None => return at,
                    Some(_) => {
                        let next = self.spread(start, at, prefix.clone(), found);
                        at = skip_to_separator(&self.code, next.max(at));
                    }
                }
            }
        }
        let end = word_end(&self.code, at);
        let name: String = self.code[at..end].iter().collect();
        if !name.is_empty() && name != "self" {
            prefix.push(name);
        }
        if starts_with(&self.code, end, "::") && self.code.get(end + 2) != Some(&'<') {
            return self.spread(start, end + 2, prefix, found);
        }
        found.push(Mention {
            path: prefix,
            line: self.line(start),
        });
        end
    }

    /// Names of the `mod name { … }` blocks around a position, outermost first.
    fn inline_modules(&self, at: usize) -> Vec<String> {
        let mut names = Vec::new();
        for start in find_word(&self.tokens[..at], "mod ") {
            let name_at = skip_space(&self.tokens, start + 4);
            let end = word_end(&self.tokens, name_at);
            let open = skip_space(&self.tokens, end);
            if self.tokens.get(open) == Some(&'{') && closing(&self.tokens, open) > at {
                names.push(self.tokens[name_at..end].iter().collect());
            }
        }
        names
    }

    fn blank_test_code(&mut self) {
        if !find_word(&self.tokens, "#![cfg(test)]").is_empty() {
            self.blank(0, self.tokens.len());
            return;
        }
        while let Some((start, end)) = self.first_test_item() {
            let item: String = self.code[start..end].iter().collect();
            if let Some(name) = own_file(&item) {
                self.test_files.push(name);
            }
            self.blank(start, end);
        }
    }

    fn first_test_item(&self) -> Option<(usize, usize)> {
        for start in find_word(&self.tokens, "#[cfg(") {
            let end = closing(&self.tokens, start + 1) + 1;
            let condition = &self.tokens[start..end];
            if find_word(condition, "test").is_empty() || !find_word(condition, "not(").is_empty() {
                continue;
            }
            return Some((start, item_end(&self.tokens, end)));
        }
        None
    }

    fn blank(&mut self, start: usize, end: usize) {
        for text in [&mut self.code, &mut self.tokens] {
            for c in &mut text[start..end] {
                if *c != '\n' {
                    *c = ' ';
                }
            }
        }
    }
}

/// `mod name;` in the text of an item: the `#[path]` file if one is given, else the name.
fn own_file(item: &str) -> Option<String> {
    let declaration = item.trim_end().strip_suffix(';')?;
    if let Some((_, rest)) = declaration.split_once("path = \"") {
        return rest.split('"').next().map(str::to_owned);
    }
    let (_, name) = declaration.rsplit_once("mod ")?;
    Some(name.trim().to_owned())
}

/// End of the item that starts after its first attribute: its `;` or closing brace.
fn item_end(text: &[char], mut at: usize) -> usize {
    while at < text.len() {
        match text[at] {
            '(' | '[' => at = closing(text, at),
            '{' => return closing(text, at) + 1,
            ';' => return at + 1,
            _ => {}
        }
        at += 1;
    }
    text.len()
}

/// Position of the bracket that closes the one at `open`; the last position when there is none.
fn closing(text: &[char], open: usize) -> usize {
    let mut depth = 0_usize;
    for (i, c) in text.iter().enumerate().skip(open) {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return i;
                }
            }
            _ => {}
        }
    }
    text.len() - 1
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn starts_with(text: &[char], at: usize, what: &str) -> bool {
    what.chars()
        .enumerate()
        .all(|(i, c)| text.get(at + i) == Some(&c))
}

fn find_word(text: &[char], word: &str) -> Vec<usize> {
    let open = word.starts_with(is_word);
    let close = word.ends_with(is_word);
    let length = word.chars().count();
    (0..text.len())
        .filter(|&at| starts_with(text, at, word))
        .filter(|&at| !open || at == 0 || !is_word(text[at - 1]))
        .filter(|&at| !close || !text.get(at + length).is_some_and(|c| is_word(*c)))
        .collect()
}

fn skip_space(text: &[char], mut at: usize) -> usize {
    while text.get(at).is_some_and(|c| c.is_whitespace()) {
        at += 1;
    }
    at
}

fn skip_to_separator(text: &[char], mut at: usize) -> usize {
    while text.get(at).is_some_and(|c| !matches!(c, ',' | '}')) {
        at += 1;
    }
    at
}

fn word_end(text: &[char], mut at: usize) -> usize {
    while text.get(at).is_some_and(|c| is_word(*c)) {
        at += 1;
    }
    at
}

/// The text without comments, and without comments and contents of strings.
fn without_comments(text: &str) -> (Vec<char>, Vec<char>) {
    let all: Vec<char> = text.chars().collect();
    let (mut code, mut tokens) = (all.clone(), all.clone());
    let mut at = 0;
    while at < all.len() {
        let (end, comment) = match (all[at], all.get(at + 1)) {
            ('/', Some('/')) => (line_end(&all, at), true),
            ('/', Some('*')) => (block_comment_end(&all, at), true),
            ('"', _) => (string_end(&all, at), false),
            ('\'', _) => (character_end(&all, at), false),
            _ => {
                at += 1;
                continue;
            }
        };
        for i in at..end {
            if all[i] != '\n' {
                tokens[i] = ' ';
                if comment {
                    code[i] = ' ';
                }
            }
        }
        at = end.max(at + 1);
    }
    (code, tokens)
}

fn line_end(all: &[char], at: usize) -> usize {
    (at..all.len())
        .find(|i| all[*i] == '\n')
        .unwrap_or(all.len())
}

fn block_comment_end(all: &[char], start: usize) -> usize {
    let mut depth = 0;
    let mut at = start;
    while at < all.len() {
        if starts_with(all, at, "/*") {
            depth += 1;
            at += 2;
        } else if starts_with(all, at, "*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    all.len()
}

/// End of the string that opens at `start`; raw strings are known by what stands before the quote.
fn string_end(all: &[char], start: usize) -> usize {
    let hashes = all[..start].iter().rev().take_while(|c| **c == '#').count();
    let raw = all[..start - hashes].ends_with(&['r']);
    let mut at = start + 1;
    while at < all.len() {
        if !raw && all[at] == '\\' {
            at += 2;
            continue;
        }
        if all[at] == '"' && (!raw || (1..=hashes).all(|i| all.get(at + i) == Some(&'#'))) {
            return at + 1;
        }
        at += 1;
    }
    all.len()
}

/// End of a character literal, or just the quote of a lifetime.
fn character_end(all: &[char], at: usize) -> usize {
    if all.get(at + 1) == Some(&'\\') {
        return (at + 3..all.len())
            .find(|i| all[*i] == '\'')
            .map_or(all.len(), |i| i + 1);
    }
    if all.get(at + 2) == Some(&'\'') {
        return at + 3;
    }
    at + 1
}
