//! The matrix itself: its cases are what they say.

use crate::matrix;
use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::section::SectionModel;

#[test]
fn the_bluff_deck_is_unstable_from_the_start() {
    let table = matrix::bluff_table();
    let points = table.points(Derivative::A2);
    assert_eq!(points.len(), 8);
    assert!(points.iter().all(|p| p.value > 0.0));
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::with_model(&structure, &matrix::bluff_model()).unwrap();
    // 4 ζ J = ρ B⁴ A2* for rotation alone: 1.5 m/s
    assert!(matrix::fastest_growth(&section, 1.4) < 0.0);
    assert!(matrix::fastest_growth(&section, 1.6) > 0.0);
}

#[test]
fn measured_decks_made_bluff_differ_in_a2_alone() {
    for deck in matrix::decks() {
        let bluff = matrix::made_bluff(&deck);
        assert!(bluff.points(Derivative::A2).iter().all(|p| p.value >= 0.1));
        for derivative in deck.derivatives().filter(|d| *d != Derivative::A2) {
            assert_eq!(bluff.points(derivative), deck.points(derivative));
        }
    }
}

#[test]
fn the_matrix_has_all_decks_and_sections() {
    assert_eq!(matrix::decks().len(), 5);
    let motions: Vec<usize> = matrix::sections()
        .iter()
        .map(|s| s.section.dofs().len())
        .collect();
    assert_eq!(motions, [2, 2, 3, 3, 3]);
    assert!(matrix::sections_of_two().iter().all(|s| !s.name.is_empty()));
}
