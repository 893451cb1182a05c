//! Lines of a terminal.

/// Columns of a terminal that nobody has widened.
pub(super) const COLUMNS: usize = 80;
/// Width of the words that begin an entry.
const HANGING: usize = 10;

/// Long lines cut at spaces; what follows stands under the text of its entry. Rows of tables stay as they are.
pub(super) fn wrapped(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    for line in text.lines() {
        if line.chars().count() <= COLUMNS || is_row(line) {
            all.push_str(line);
            all.push('\n');
            continue;
        }
        let entry = line.chars().take(HANGING).count() == HANGING
            && line.chars().nth(HANGING - 1) == Some(' ')
            && line.chars().nth(HANGING).is_some_and(|c| c != ' ');
        let start: String = line.chars().take_while(|c| *c == ' ').collect();
        let indent = if entry { HANGING } else { start.len().max(2) };
        // the words that begin an entry keep their distance
        let head: String = line.chars().take(HANGING).collect();
        let (start, body) = match entry && start.is_empty() {
            true => (&head, &line[head.len()..]),
            false => (&start, line),
        };
        all.push_str(&filled(start, body, indent));
    }
    all
}

/// `head`, and `text` cut at spaces in a column of its own beside it: a row of a table whose last cell is a sentence.
pub(super) fn beside(head: &str, text: &str) -> String {
    filled(&format!("{head} "), text, head.chars().count() + 1)
}

/// What stands at the `start` of a line, then the words of the text; further lines begin with as many spaces as `indent` says.
fn filled(start: &str, text: &str, indent: usize) -> String {
    let (mut all, mut length) = (start.to_owned(), start.chars().count());
    for (i, word) in text.split_whitespace().enumerate() {
        let width = word.chars().count();
        if i > 0 && length + 1 + width > COLUMNS {
            all.push('\n');
            all.push_str(&" ".repeat(indent));
            length = indent;
        } else if i > 0 {
            all.push(' ');
            length += 1;
        }
        all.push_str(word);
        length += width;
    }
    all + "\n"
}

/// Whether a line is a row of a table: cells with two spaces or more between them, and not merely words that begin an entry.
fn is_row(line: &str) -> bool {
    let gaps = line.trim().split("  ").filter(|cell| !cell.is_empty());
    gaps.count() > 2
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, beside, wrapped};

    #[test]
    fn long_lines_hang_under_their_entry_and_lose_no_word() {
        let long = "word ".repeat(40);
        let text =
            format!("Deck      {long}\n          note: {long}\nwarning: {long}\nshort  as it is\n");
        let cut = wrapped(&text);
        assert!(cut.lines().all(|l| l.chars().count() <= COLUMNS), "{cut}");
        let row = format!("{:<40} {:>20} {:>20} of a table\n", "a row", 1.5, 2.5);
        assert_eq!(wrapped(&row), row);
        let words = |t: &str| t.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&cut), words(&text));
        assert!(cut.starts_with("Deck      word") && cut.contains("\n          word"));
        assert!(cut.ends_with("short  as it is\n"));
    }

    #[test]
    fn a_sentence_stands_in_its_column() {
        let head = format!("{:<18} {:<13}", "Laguerre", "eigenvalues");
        let row = beside(&head, &"word ".repeat(30));
        assert!(row.lines().all(|l| l.chars().count() <= COLUMNS), "{row}");
        assert!(
            row.lines()
                .skip(1)
                .all(|l| l.starts_with(&format!("{:33}word", "")))
        );
        assert_eq!(row.split_whitespace().count(), 32);
        assert_eq!(wrapped(&row), row);
    }
}
