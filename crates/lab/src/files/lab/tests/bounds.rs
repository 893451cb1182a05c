//! Files that would take the whole memory or never end.

use super::*;
use std::io::Write;

/// A MATLAB file with one compressed element of `inflated` zeros.
fn bomb(inflated: usize) -> Vec<u8> {
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let zeros = vec![0; 1 << 20];
    for _ in 0..inflated >> 20 {
        zlib.write_all(&zeros).unwrap();
    }
    let packed = zlib.finish().unwrap();
    let mut bytes = vec![b' '; 124];
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(15_u32.to_le_bytes());
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}

#[test]
fn a_deflate_bomb_is_not_inflated() {
    // 1.5 MB that would become 300 MB and, as numbers, as much again and again
    let said = complaint("a.mat", &bomb(300 << 20), None);
    assert_eq!(
        said,
        "byte 128: expected compressed variables of at most 268435456 bytes (cut the recording), found more"
    );
}

/// 350 million samples that were never written, in a file that is long enough to hold them packed.
#[test]
fn a_shape_without_samples_is_refused() {
    let mut bytes = std::fs::read(file("unwritten.h5")).unwrap();
    bytes.resize(4 << 20, 0);
    let said = complaint("a.h5", &bytes, None);
    assert!(
        said.starts_with("y: expected at most 33554432 numbers"),
        "{said}"
    );
    assert!(said.ends_with("found 350000000"), "{said}");
}

/// A TDMS file of one segment that names `objects` channels without samples.
fn many_objects(objects: u32) -> Vec<u8> {
    let mut metadata = objects.to_le_bytes().to_vec();
    for i in 0..objects {
        let path = format!("/'g'/'{i}'");
        metadata.extend((path.len() as u32).to_le_bytes());
        metadata.extend(path.as_bytes());
        metadata.extend(u32::MAX.to_le_bytes());
        metadata.extend(0_u32.to_le_bytes());
    }
    let mut bytes = b"TDSm".to_vec();
    for x in [0b110_u32, 4713] {
        bytes.extend(x.to_le_bytes());
    }
    let length = metadata.len() as u64;
    bytes.extend(length.to_le_bytes());
    bytes.extend(length.to_le_bytes());
    bytes.extend(metadata);
    bytes
}

#[test]
fn many_objects_are_read_soon_and_too_many_not_at_all() {
    let start = Instant::now();
    let set = ChannelSet::parse(many_objects(20_000), "tdms", None).unwrap();
    assert_eq!(set.left_out.len(), 20_000);
    // a message holds some of them
    assert!(set.listing().len() < 4000);
    let said = complaint("a.tdms", &many_objects(400_000), None);
    assert!(
        said.ends_with("expected at most 20000 channels and groups, found more"),
        "{said}"
    );
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn a_row_is_no_book() {
    let line = "1,".repeat(1 << 20);
    let said = complaint("a.csv", format!("a,b\n1,2\n{line}\n").as_bytes(), None);
    assert_eq!(
        said,
        "line 3: expected a row of at most 1048576 bytes, found 2097152 bytes"
    );
    // what stood there is quoted in part
    let word = "x".repeat(50_000);
    let said = complaint("a.csv", format!("a,b\n1,2\n3,{word}\n").as_bytes(), None);
    assert!(
        said.len() < 1200 && said.ends_with("(50002 characters)"),
        "{said}"
    );
}
