//! Vectors of four numbers: those of this processor, or four single ones.

#[cfg(target_arch = "x86_64")]
use pulp::NullaryFnOnce;
use pulp::{Scalar256b, Simd, f64x4, m64x4};

/// Numbers in a vector. Rows are padded to whole groups of this many, so that the inner loop has a fixed length.
pub const LANES: usize = 4;

/// Vectors of four numbers, of this processor or made of single ones.
pub(super) trait FourLanes: Simd<f64s = f64x4, m64s = m64x4> {}
impl<S: Simd<f64s = f64x4, m64s = m64x4>> FourLanes for S {}

/// What runs on vectors of four numbers, compiled for each kind of them. Sums are named as vectors, for left to the compiler they
/// would lie on the stack wherever a crate is not optimised together with all others.
pub(super) trait OnLanes {
    type Output;
    fn run<S: FourLanes>(self, simd: S) -> Self::Output;
}

/// Runs a job on vectors of four numbers where this processor has them: wider ones are no faster for so few.
#[inline(always)]
pub(super) fn on_lanes<J: OnLanes>(job: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(vectors) = pulp::x86::V3::try_new() {
        return vectors.vectorize(On(job, vectors));
    }
    on_plain_numbers(job)
}

/// Apart, so that it takes no room where it is not used.
#[inline(never)]
pub(super) fn on_plain_numbers<J: OnLanes>(job: J) -> J::Output {
    job.run(Scalar256b)
}

#[cfg(target_arch = "x86_64")]
struct On<J, S>(J, S);

#[cfg(target_arch = "x86_64")]
impl<J: OnLanes, S: FourLanes> NullaryFnOnce for On<J, S> {
    type Output = J::Output;

    #[inline(always)]
    fn call(self) -> J::Output {
        self.0.run(self.1)
    }
}
