//! A small tree of XML elements: read with line numbers, so that every finding can name its place, and written.

use super::standard::{is_printable, printable};
use crate::error::{Error, Place, Result};
use quick_xml::XmlVersion;
use quick_xml::escape::partial_escape;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

/// Elements nested deeper than this are refused; a model description needs five levels, annotations a few more.
const MAX_DEPTH: usize = 100;
/// Attributes of one element; the longest of the standard has about twenty, and each is compared with all others.
const MAX_ATTRIBUTES: usize = 200;

/// One element: text between children is dropped, since a model description holds none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Element {
    /// Name, with its prefix if it has one.
    pub name: String,
    /// Line of the opening tag, counted from 1; 0 for an element to be written.
    pub line: usize,
    /// Names and unescaped values, in the order of the text.
    pub attributes: Vec<(String, String)>,
    /// Child elements, in the order of the text.
    pub children: Vec<Element>,
}

impl Element {
    /// An element to be written.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            line: 0,
            attributes: Vec::new(),
            children: Vec::new(),
        }
    }

    /// The same with one more attribute.
    pub fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.attributes.push((name.to_owned(), value.to_string()));
        self
    }

    /// The same with one more attribute if there is a value.
    pub fn with_any(self, name: &str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// The same with more children.
    pub fn containing(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// The document: an element per line, two spaces per level.
    pub fn document(&self) -> String {
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        self.write(&mut text, 0);
        text
    }

    fn write(&self, text: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        text.push_str(&format!("{indent}<{}", self.name));
        for (name, value) in &self.attributes {
            // whatever a name or a source brings along, the document is XML
            let value = partial_escape(printable(value)).replace('"', "&quot;");
            text.push_str(&format!(" {name}=\"{value}\""));
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            child.write(text, depth + 1);
        }
        text.push_str(&format!("{indent}</{}>\n", self.name));
    }

    /// Reads a document.
    ///
    /// # Errors
    /// [`Error::Input`] with the line where the text stops being XML.
    pub fn parse(text: &str) -> Result<Self> {
        let mut strange = text.char_indices().filter(|(_, c)| !is_printable(*c));
        if let Some((at, c)) = strange.next() {
            let line = 1 + text[..at].matches('\n').count();
            return Err(malformed(line, &forbidden(c)));
        }
        let mut reader = Reader::from_str(text);
        // positions only grow
        let (mut line, mut position) = (1, 0);
        let mut open: Vec<Element> = Vec::new();
        loop {
            let event = reader.read_event();
            let end = usize::try_from(reader.buffer_position()).unwrap_or(text.len());
            let passed = text.as_bytes().get(position..end).unwrap_or_default();
            line += passed.iter().filter(|b| **b == b'\n').count();
            position = end.max(position);
            let closed = match event.map_err(|e| malformed(line, &e))? {
                Event::Start(tag) => {
                    if open.len() == MAX_DEPTH {
                        return Err(malformed(line, &"elements nested more than 100 deep"));
                    }
                    open.push(element(&tag, line)?);
                    None
                }
                Event::Empty(tag) => Some(element(&tag, line)?),
                Event::End(_) => open.pop(),
                Event::Eof => {
                    let missing = open.pop().map_or_else(
                        || "no element at all".to_owned(),
                        |e| format!("the end of the file before </{}>", e.name),
                    );
                    return Err(malformed(line, &missing));
                }
                _ => None,
            };
            if let Some(closed) = closed {
                match open.last_mut() {
                    Some(parent) => parent.children.push(closed),
                    None => return Ok(closed),
                }
            }
        }
    }

    /// Value of an attribute, if it is there.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let mut all = self.attributes.iter();
        all.find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    /// The first child of that name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|c| c.name == name)
    }

    /// All children of that name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |c| c.name == name)
    }
}

fn element(tag: &BytesStart<'_>, line: usize) -> Result<Element> {
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        if attributes.len() == MAX_ATTRIBUTES {
            return Err(malformed(line, &"an element of more than 200 attributes"));
        }
        let attribute = attribute.map_err(|e| malformed(line, &e))?;
        let value = attribute
            .normalized_value(XmlVersion::Implicit1_0)
            .map_err(|e| malformed(line, &e))?;
        if let Some(c) = value.chars().find(|c| !is_printable(*c)) {
            return Err(malformed(line, &forbidden(c)));
        }
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    Ok(Element {
        name: tag.name().as_ref().to_owned(),
        line,
        attributes,
        children: Vec::new(),
    })
}

fn forbidden(c: char) -> String {
    let code = u32::from(c);
    format!("the character U+{code:04X}, which XML cannot hold")
}

fn malformed(line: usize, found: &dyn std::fmt::Display) -> Error {
    Error::input(Place::line(line), "well-formed XML", found.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_keep_order_line_and_empty_attributes() {
        let text = "<?xml version=\"1.0\"?>\n<!-- c -->\n<a x='1 &lt; &quot;2&quot;'>\n <b d=\"\"/>text<c/>\n</a>";
        let root = Element::parse(text).unwrap();
        assert_eq!((root.name.as_str(), root.line), ("a", 3));
        assert_eq!(root.attribute("x"), Some("1 < \"2\""));
        assert_eq!(root.child("b").unwrap().attribute("d"), Some(""));
        assert_eq!(root.child("b").unwrap().attribute("e"), None);
        assert_eq!(root.child("c").unwrap().line, 4);
    }

    #[test]
    fn what_is_written_reads_back() {
        // control characters are left out
        let mut given = Element::new("b").with("d", "1 < \"2\u{1b}\" & 3\u{0} > 2");
        let child = Element::new("b").with("d", "1 < \"2\" & 3 > 2");
        assert!(Element::parse(&given.document()).is_ok());
        given.attributes[0].1 = "1 < \"2\" & 3 > 2".into();
        assert_eq!(given, child);
        let root = Element::new("a")
            .with("x", 0.1)
            .with_any("y", None::<f64>)
            .containing([child.clone(), child]);
        let mut read = Element::parse(&root.document()).unwrap();
        assert_eq!((read.line, read.children[1].line), (2, 4));
        read.line = 0;
        read.children.iter_mut().for_each(|c| c.line = 0);
        assert_eq!(read, root);
    }

    #[test]
    fn broken_text_is_refused_with_its_line() {
        for (text, line) in [
            ("", 1),
            ("<a>\n<b>", 2),
            ("<a>\n<b></c></a>", 2),
            ("<a x=1/>", 1),
            ("<a>\n\n&unknown;<b y='&no;'/></a>", 3),
            ("not xml at all", 1),
            ("<a>\n<b c='\u{1}'/></a>", 2),
            ("<a>\n\n<b c='&#27;'/></a>", 3),
        ] {
            let message = Element::parse(text).unwrap_err().to_string();
            assert!(
                message.starts_with(&format!("line {line}: expected well-formed XML")),
                "{text}: {message}"
            );
        }
        let many: String = (0..300_000).map(|i| format!(" a{i}=''")).collect();
        assert!(Element::parse(&format!("<a{many}/>")).is_err());
        let deep = "<a>".repeat(200_000);
        assert!(Element::parse(&deep).is_err());
    }
}
