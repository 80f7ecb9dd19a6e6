//! Nodes of a mesh by the texts that stand behind its name.

use crate::scenes::{MeshData, unknown};

pub(super) fn names(all: &[(String, Vec<usize>)]) -> Vec<String> {
    all.iter().map(|own| own.0.clone()).collect()
}

/// Points behind the name of a mesh.
pub(super) fn nodes_of(data: &MeshData, rest: &str) -> Result<Vec<usize>, String> {
    let used = data.used();
    let wrong_number = || "[i] is the number of a node".to_string();
    if rest.is_empty() {
        let sets = [names(&data.node_sets), names(&data.groups)].concat();
        return Err(format!("a mesh has many nodes; name one by its number in [ ], or a node set: {}", sets.join(", ")));
    }
    if let Some(inside) = rest.strip_prefix('[') {
        let number: usize = inside.strip_suffix(']').and_then(|own| own.trim().parse().ok()).ok_or_else(wrong_number)?;
        let point = data.point(number).ok_or_else(|| {
            let (least, most) = (data.point_numbers.iter().min(), data.point_numbers.iter().max());
            format!(
                "the mesh has no node {number}; they are numbered from {} to {}",
                least.unwrap_or(&0),
                most.unwrap_or(&0)
            )
        })?;
        return match used[point] {
            true => Ok(vec![point]),
            false => Err(format!("node {number} belongs to no face")),
        };
    }
    let rest = rest.strip_prefix('.').ok_or_else(wrong_number)?;
    let (set, index) = match rest.strip_suffix(']').and_then(|own| own.rsplit_once('[')) {
        // a name may end with a bracket itself
        Some((set, index)) if data.node_set(rest).is_none() => {
            (set.trim_end(), Some(index.trim().parse::<usize>().map_err(|_| wrong_number())?))
        }
        _ => (rest, None),
    };
    let Some(points) = data.node_set(set) else {
        return Err(unknown("node set", set, &[names(&data.node_sets), names(&data.groups)].concat()));
    };
    if let Some(&point) = points.iter().find(|&&point| !used.get(point).copied().unwrap_or(false)) {
        let number = data.point_numbers.get(point).copied().unwrap_or(point);
        return Err(format!("node {number} of the node set belongs to no face"));
    }
    match index {
        None => Ok(points),
        Some(index) => match points.get(index) {
            Some(&point) => Ok(vec![point]),
            None => Err(format!("the node set has {} nodes, counted from 0", points.len())),
        },
    }
}
