//! An order of what needs each other.

/// An order in which each of some comes after what it needs, else as they are given, and a circle if there is one.
pub(super) fn ordered(all: impl IntoIterator<Item = usize>, needs: &[Vec<usize>]) -> (Vec<usize>, Option<Vec<usize>>) {
    // how many of the needs of each have been looked at, and one more of what is in the order
    let (mut order, mut looked) = (Vec::new(), vec![0; needs.len()]);
    for first in all {
        let mut path = if looked[first] == 0 { vec![first] } else { Vec::new() };
        while let Some(&place) = path.last() {
            looked[place] += 1;
            match needs[place].get(looked[place] - 1) {
                Some(&need) if looked[need] == 0 => path.push(need),
                // it is on the path
                Some(&need) if looked[need] <= needs[need].len() => {
                    let from = path.iter().position(|own| *own == need).unwrap_or(0);
                    return (order, Some([&path[from..], &[need]].concat()));
                }
                Some(_) => {}
                None => {
                    order.push(place);
                    path.pop();
                }
            }
        }
    }
    (order, None)
}
