use crate::elements::{Parameter, RunScalar, State};
use crate::scalar::{Complex64, Lanes, Scalar};

/// A number at one time, from the states of some nodes and the multipliers of some constraints.
pub trait Quantity: Send + Sync + 'static {
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Number of coordinates of its nodes together.
    fn dofs(&self) -> usize;
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Whether it depends on (a, v, q) of its nodes; what is not read is not differentiated.
    fn reads(&self) -> [bool; 3] {
        [true; 3]
    }
    /// The value for states `s` of its nodes and multipliers `mu` of its constraints, one after the other.
    fn value<S: Scalar>(&self, s: State<S>, mu: &[S], p: &[S], t: S) -> S;
}

/// What the framework asks of a quantity in one scalar.
pub trait QuantityIn<S> {
    /// The value.
    fn value_in(&self, s: State<S>, mu: &[S], p: &[S], t: S) -> S;
}

/// A quantity with its type erased; every [`Quantity`] is one.
pub trait AnyQuantity: QuantityIn<f64> + QuantityIn<Complex64> + QuantityIn<Lanes> + Send + Sync {
    /// Number of coordinates.
    fn dof_count(&self) -> usize;
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Whether it depends on (a, v, q).
    fn reads_states(&self) -> [bool; 3];
}

impl<Q: Quantity, S: Scalar> QuantityIn<S> for Q {
    fn value_in(&self, s: State<S>, mu: &[S], p: &[S], t: S) -> S {
        self.value(s, mu, p, t)
    }
}

impl<Q: Quantity> AnyQuantity for Q {
    fn dof_count(&self) -> usize {
        self.dofs()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn reads_states(&self) -> [bool; 3] {
        self.reads()
    }
}

/// The scalars of runs, as functionals see them.
pub trait FunctionalScalar: RunScalar {
    /// The quantity, in this scalar.
    fn quantity(quantity: &dyn AnyQuantity) -> &dyn QuantityIn<Self>;
}

macro_rules! view_quantity {
    ($($scalar:ty),*) => {$(
        impl FunctionalScalar for $scalar {
            fn quantity(quantity: &dyn AnyQuantity) -> &dyn QuantityIn<Self> {
                quantity
            }
        }
    )*};
}
view_quantity!(f64, Complex64, Lanes);
