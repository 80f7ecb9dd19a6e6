//! An order of what needs each other.

/// An order in which each of some comes after what it needs, else as they are given, and a circle if there is one.
pub(super) fn ordered(all: impl IntoIterator<Item = usize>, needs: &[Vec<usize>]) -> (Vec<usize>, Option<Vec<usize>>) {
    let (mut order, mut done) = (Vec::new(), vec![false; needs.len()]);
    // a place and how many of its needs have been looked at
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut on_path = vec![false; needs.len()];
    for first in all {
        if done[first] {
            continue;
        }
        path.push((first, 0));
        on_path[first] = true;
        while let Some((place, looked)) = path.last_mut() {
            let place = *place;
            match needs[place].get(*looked) {
                Some(&need) => {
                    *looked += 1;
                    if on_path[need] {
                        let from = path.iter().position(|own| own.0 == need).unwrap_or(0);
                        let mut circle: Vec<usize> = path[from..].iter().map(|own| own.0).collect();
                        circle.push(need);
                        return (order, Some(circle));
                    }
                    if !done[need] {
                        on_path[need] = true;
                        path.push((need, 0));
                    }
                }
                None => {
                    done[place] = true;
                    on_path[place] = false;
                    order.push(place);
                    path.pop();
                }
            }
        }
    }
    (order, None)
}
