//! MATLAB files.

/// An uncompressed MATLAB file of version 5 with real arrays.
pub fn file(arrays: &[(&str, Vec<i32>, Vec<f64>)]) -> Vec<u8> {
    let element = |kind: u32, bytes: Vec<u8>| {
        let mut all = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
        all.extend(&bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    };
    let mut file = vec![b' '; 124];
    file.extend([0, 1, b'I', b'M']);
    for (name, size, numbers) in arrays {
        let size = size.iter().flat_map(|x| x.to_le_bytes()).collect();
        let numbers = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        // class 6 is double
        let parts = [
            element(6, vec![6, 0, 0, 0, 0, 0, 0, 0]),
            element(5, size),
            element(1, name.as_bytes().to_vec()),
            element(9, numbers),
        ];
        file.extend(element(14, parts.concat()));
    }
    file
}
