//! A deck on its springs: cases of decks and sections, and sections described in two ways.

#[path = "../common/matrix.rs"]
mod matrix;

mod cases;
mod typical_section;
