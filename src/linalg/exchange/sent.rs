//! What ranks tell each other, as numbers.

use std::slice::Iter;

/// Written as numbers, and read from them with the same bits.
pub trait Sent: Sized {
    /// Adds its numbers.
    fn write(&self, numbers: &mut Vec<f64>);
    /// Takes as many as it has added.
    fn read(numbers: &mut Iter<f64>) -> Self;
}

impl Sent for f64 {
    fn write(&self, numbers: &mut Vec<f64>) {
        numbers.push(*self);
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        *numbers.next().expect("as many numbers as were written")
    }
}

/// Whole numbers that a double holds exactly.
macro_rules! whole {
    ($($name:ty),*) => {$(
        impl Sent for $name {
            fn write(&self, numbers: &mut Vec<f64>) {
                numbers.push(*self as f64);
            }
            fn read(numbers: &mut Iter<f64>) -> Self {
                f64::read(numbers) as $name
            }
        }
    )*};
}
whole!(u8, usize);

impl Sent for bool {
    fn write(&self, numbers: &mut Vec<f64>) {
        u8::from(*self).write(numbers);
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        u8::read(numbers) == 1
    }
}

impl<T: Sent> Sent for Vec<T> {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.len().write(numbers);
        self.iter().for_each(|own| own.write(numbers));
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        (0..usize::read(numbers)).map(|_| T::read(numbers)).collect()
    }
}

impl Sent for String {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.as_bytes().to_vec().write(numbers);
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        String::from_utf8(Vec::read(numbers)).expect("a text was written")
    }
}

impl Sent for &'static str {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.to_string().write(numbers);
    }
    // words of errors, of which a program has few
    fn read(numbers: &mut Iter<f64>) -> Self {
        Box::leak(String::read(numbers).into_boxed_str())
    }
}

impl<T: Sent> Sent for Option<T> {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.is_some().write(numbers);
        self.iter().for_each(|own| own.write(numbers));
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        bool::read(numbers).then(|| T::read(numbers))
    }
}

impl<T: Sent, E: Sent> Sent for Result<T, E> {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.is_ok().write(numbers);
        match self {
            Ok(own) => own.write(numbers),
            Err(error) => error.write(numbers),
        }
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        if bool::read(numbers) { Ok(T::read(numbers)) } else { Err(E::read(numbers)) }
    }
}

impl<A: Sent, B: Sent> Sent for (A, B) {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.0.write(numbers);
        self.1.write(numbers);
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        (A::read(numbers), B::read(numbers))
    }
}

impl<const N: usize> Sent for [usize; N] {
    fn write(&self, numbers: &mut Vec<f64>) {
        self.iter().for_each(|own| own.write(numbers));
    }
    fn read(numbers: &mut Iter<f64>) -> Self {
        std::array::from_fn(|_| usize::read(numbers))
    }
}

/// Sends a structure by its fields.
#[macro_export]
macro_rules! sent_by_fields {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::exchange::Sent for $name {
            fn write(&self, numbers: &mut Vec<f64>) {
                let $name { $($field),* } = self;
                $($field.write(numbers);)*
            }
            fn read(numbers: &mut std::slice::Iter<f64>) -> Self {
                $name { $($field: $crate::exchange::Sent::read(numbers)),* }
            }
        }
    };
}

/// Sends one of several variants by its number and its fields.
#[macro_export]
macro_rules! sent_by_variants {
    ($name:ident { $($number:literal $variant:ident { $($field:tt: $bound:ident),* }),* $(,)? }) => {
        impl $crate::exchange::Sent for $name {
            fn write(&self, numbers: &mut Vec<f64>) {
                match self {
                    $($name::$variant { $($field: $bound),* } => {
                        numbers.push(f64::from($number as u8));
                        $($bound.write(numbers);)*
                    })*
                }
            }
            fn read(numbers: &mut std::slice::Iter<f64>) -> Self {
                match <u8 as $crate::exchange::Sent>::read(numbers) {
                    $($number => $name::$variant { $($field: $crate::exchange::Sent::read(numbers)),* },)*
                    other => unreachable!("variant {other} of {}", stringify!($name)),
                }
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sent_is_read_with_the_same_bits() {
        let sent = vec![
            (Some(f64::from_bits(0x7ff0_0000_dead_beef)), Ok("a \u{3b1} \n".to_string())),
            (None, Err([3, 1 << 52])),
            (Some(-0.0), Ok(String::new())),
        ];
        let mut numbers = Vec::new();
        sent.write(&mut numbers);
        let mut rest = numbers.iter();
        let read = Vec::<(Option<f64>, Result<String, [usize; 2]>)>::read(&mut rest);
        let bits = |all: &[(Option<f64>, _)]| all.iter().map(|own| own.0.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&sent), bits(&read));
        assert!(sent.iter().zip(&read).all(|(sent, read)| sent.1 == read.1) && rest.next().is_none());
    }
}
