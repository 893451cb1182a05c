//! Order of the columns of a system.

/// Columns of the whole system: an optional constant, then every column of one input for all inputs, interleaved so
/// that fewer filters are a leading subset.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    pub inputs: usize,
    pub per_input: usize,
    pub constant: bool,
}

impl Layout {
    /// Number of columns with `active` inputs.
    pub fn width(&self, active: usize) -> usize {
        usize::from(self.constant) + self.per_input * active
    }

    /// Column `c` of input `j` in the whole system.
    pub fn index(&self, c: usize, j: usize) -> usize {
        usize::from(self.constant) + c * self.inputs + j
    }

    /// Number of columns of the whole system that the first `per_input` columns of every input take.
    pub fn leading(&self, per_input: usize) -> usize {
        usize::from(self.constant) + per_input * self.inputs
    }

    /// Number of leading columns of a system of one input that hold its first `count` columns.
    pub fn leading_alone(&self, count: usize) -> usize {
        usize::from(self.constant) + count
    }

    /// Columns of the whole system that a set of inputs takes, in the order of its own system.
    pub fn map(&self, active: &[usize]) -> Vec<usize> {
        let constant = self.constant.then_some(0);
        let columns =
            (0..self.per_input).flat_map(|c| active.iter().map(move |&j| self.index(c, j)));
        constant.into_iter().chain(columns).collect()
    }
}
