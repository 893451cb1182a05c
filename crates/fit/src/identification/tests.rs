//! Fits to records and tables of all decks.

mod broadband;
mod deck;
mod training;
