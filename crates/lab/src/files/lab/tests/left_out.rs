//! Channels that are no numbers are left out by name, and what stands behind them is read.

use super::*;

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A group with a channel of two texts and one of two complex numbers before one of two doubles, two blocks.
#[test]
fn tdms_texts_and_complex_numbers() {
    let object = |name: &str, index: &[u32]| {
        let path = format!("/'g'/'{name}'");
        let start = [words(&[path.len() as u32]), path.into_bytes()].concat();
        [start, words(index), words(&[0])].concat()
    };
    let objects = [
        object("note", &[28, 0x20, 1, 2, 0, 12, 0]), // 12 bytes in all
        object("z", &[20, 0x0010_000d, 1, 2, 0]),
        object("y", &[20, 10, 1, 2, 0]),
    ];
    let metadata = [words(&[3]), objects.concat()].concat();
    let block = |y: [f64; 2]| {
        let texts = [&words(&[1, 4])[..], b"abcd"].concat();
        let numbers = [7.0, 0.0, 8.0, 0.0, y[0], y[1]];
        [
            texts,
            numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
        ]
        .concat()
    };
    let raw = [block([1.0, 2.0]), block([3.0, 4.0])].concat();
    let (all, first) = ((metadata.len() + raw.len()) as u32, metadata.len() as u32);
    let lead_in = [b"TDSm".to_vec(), words(&[0b1110, 4713, all, 0, first, 0])].concat();
    let set = tdms::parse(&[lead_in, metadata, raw].concat(), Some("g")).unwrap();
    assert_eq!(set.channel("y").unwrap().samples, [1.0, 2.0, 3.0, 4.0]);
    let left_out = [("note", "text"), ("z", "complex numbers")];
    assert_eq!(
        set.left_out,
        left_out.map(|(a, b)| (a.to_owned(), b.to_owned()))
    );
}

#[test]
fn matlab_texts_and_a_struct_that_cannot_be_read() {
    let mut bytes = std::fs::read(file("v5_plain.mat")).unwrap();
    let set = ChannelSet::parse(bytes.clone(), "mat", None).unwrap();
    assert!(
        set.listing().contains("not read: run.label (text)"),
        "{}",
        set.listing()
    );
    bytes[128 + 16] = 99; // the class of `motion`
    assert_eq!(
        complaint("a.mat", &bytes, Some("motion")),
        "group: expected a struct that can be read, found `motion` (corrupt, or of a kind that is not known)"
    );
}
