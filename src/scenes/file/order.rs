//! In which order entries are made, and definitions evaluated.

use super::reader::{Item, NodePlace, Reader, Value};

impl Reader {
    /// What others refer to comes before these, and otherwise the order of the file is kept.
    pub(super) fn order(&mut self, items: &[Item]) -> Vec<usize> {
        let needs: Vec<Vec<usize>> = items
            .iter()
            .map(|item| {
                let mut needs = Vec::new();
                item.fields.values.iter().for_each(|(_, _, value)| collect_items(value, &mut needs));
                needs
            })
            .collect();
        let mut by_file: Vec<usize> = (0..items.len()).collect();
        // entries of a loop stand at one place
        by_file.sort_by_key(|&place| items[place].fields.at);
        let renumbered: Vec<usize> = {
            let mut places = vec![0; items.len()];
            by_file.iter().enumerate().for_each(|(rank, &place)| places[place] = rank);
            places
        };
        let ranked: Vec<Vec<usize>> =
            by_file.iter().map(|&place| needs[place].iter().map(|&need| renumbered[need]).collect()).collect();
        let (order, circle) = ordered(&ranked);
        if let Some(circle) = circle {
            let names: Vec<&str> = circle.iter().map(|&rank| &*items[by_file[rank]].name).collect();
            let at = items[by_file[circle[0]]].fields.at;
            self.wrong(at, format!("\"{}\" needs itself to be there: {}", names[0], names.join(" -> ")));
        }
        order.into_iter().map(|rank| by_file[rank]).collect()
    }
}

fn collect_items(value: &Value, items: &mut Vec<usize>) {
    match value {
        Value::Item(item) | Value::Group(item, _) => items.push(*item),
        Value::Node(NodePlace { item: Some(item), .. }) => items.push(*item),
        Value::Fields(fields) => fields.values.iter().for_each(|(_, _, own)| collect_items(own, items)),
        Value::NamedNodes(nodes) => items.extend(nodes.iter().filter_map(|own| own.place.item)),
        Value::List(list) => list.iter().for_each(|(_, own)| collect_items(own, items)),
        _ => {}
    }
}

/// An order in which each comes after what it needs, else by number, and a circle if there is one.
pub(super) fn ordered(needs: &[Vec<usize>]) -> (Vec<usize>, Option<Vec<usize>>) {
    let (mut order, mut done) = (Vec::new(), vec![false; needs.len()]);
    // a place and how many of its needs have been looked at
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut on_path = vec![false; needs.len()];
    for first in 0..needs.len() {
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
