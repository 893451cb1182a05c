//! Functions that are compiled once for each kind of vectors that a processor may have.

/// Functions of which the widest version that the processor has runs: what they call is to be `#[inline(always)]`. The order of
/// the sums, and so the bits, are the same in all versions.
///
/// ```
/// aerodeck_core::vectorised! {
///     /// Adds one vector to another.
///     fn add<'a>(to: &'a mut [f64], from: &'a [f64]) -> () {
///         for (t, f) in to.iter_mut().zip(from) {
///             *t += f;
///         }
///     }
/// }
/// let mut to = [1.0, 2.0];
/// add(&mut to, &[0.5, 0.5]);
/// assert_eq!(to, [1.5, 2.5]);
/// ```
#[macro_export]
macro_rules! vectorised {
    ($($(#[$meta:meta])* $vis:vis fn $name:ident$(<$life:lifetime>)?($($arg:ident: $ty:ty),* $(,)?) -> $ret:ty $body:block)+) => {$(
        $(#[$meta])*
        $vis fn $name$(<$life>)?($($arg: $ty),*) -> $ret {
            struct Call$(<$life>)?($($ty),*);
            impl$(<$life>)? ::pulp::NullaryFnOnce for Call$(<$life>)? {
                type Output = $ret;
                #[inline(always)]
                fn call(self) -> $ret {
                    let Self($($arg),*) = self;
                    $body
                }
            }
            ::pulp::Arch::new().dispatch(Call($($arg),*))
        }
    )+};
}
