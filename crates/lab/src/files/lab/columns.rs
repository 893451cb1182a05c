//! Arrays as channels: one per column, time along the longer side.

use super::channels::{Attribute, ChannelSet};

/// More channels than this in one array are taken for an image or a table, not for channels.
const CHANNELS_AT_MOST: usize = 512;

/// Adds an array of `shape` under `name`: a number, a channel or several. The first index of its elements runs fastest (MATLAB), or the
/// last (HDF5).
pub(super) fn push_array(
    set: &mut ChannelSet,
    name: &str,
    shape: &[usize],
    first_is_fastest: bool,
    values: Vec<f64>,
    units: &[String],
) {
    let sides: Vec<usize> = shape.iter().copied().filter(|n| *n != 1).collect();
    // one unit for all columns, or one per column
    let unit = |column: usize, columns: usize| match units {
        [one] => Some(one.clone()),
        all if all.len() == columns => Some(all[column].clone()),
        _ => None,
    };
    match (sides.len(), &sides[..]) {
        _ if values.is_empty() => set.leave_out(name, "empty"),
        (0, _) => {
            set.attributes
                .insert(name.to_owned(), Attribute::Number(values[0]));
        }
        (1, _) => set.push(name, values, unit(0, 1)),
        (2, &[rows, columns]) => {
            let (fast, slow) = match first_is_fastest {
                true => (rows, columns),
                false => (columns, rows),
            };
            let (samples, channels) = (rows.max(columns), rows.min(columns));
            // of equal sides it is the first
            let time_is_fast = fast > slow || (first_is_fastest && fast == slow);
            if channels > CHANNELS_AT_MOST {
                set.leave_out(name, format!("{rows} × {columns} numbers"));
                return;
            }
            for c in 0..channels {
                let at = |i: usize| match time_is_fast {
                    true => values[c * fast + i],
                    false => values[i * fast + c],
                };
                let column = (0..samples).map(at).collect();
                set.push(format!("{name}[{}]", c + 1), column, unit(c, channels));
            }
        }
        (dimensions, _) => set.leave_out(name, format!("an array of {dimensions} dimensions")),
    }
}
