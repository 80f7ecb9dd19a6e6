use super::graph::{Graph, Role};
use std::sync::Mutex;

/// Vertices in the order of their elimination: nested dissection, multipliers after their last neighbour.
pub fn dissect(graph: &Graph) -> Vec<u32> {
    let all: Vec<u32> = (0..graph.len() as u32).collect();
    let mut place = vec![u32::MAX; graph.len()];
    for (position, &vertex) in nested_dissection(graph, &all).iter().enumerate() {
        place[vertex as usize] = position as u32;
    }
    let key = |vertex: u32| {
        let own = place[vertex as usize];
        if graph.roles[vertex as usize] != Role::Multiplier {
            return (own, 0, own);
        }
        let primal = |&&neighbour: &&u32| graph.roles[neighbour as usize] == Role::Primal;
        let last = graph.neighbours(vertex as usize).iter().filter(primal).map(|&v| place[v as usize]).max();
        (last.unwrap_or(own), 1, own)
    };
    let mut order = all;
    order.sort_by_cached_key(|&vertex| key(vertex));
    order
}

/// METIS keeps the state of its random numbers in one place.
static METIS: Mutex<()> = Mutex::new(());

/// The vertices given, in an order of little fill.
///
/// Source: Karypis & Kumar (1998), METIS.
fn nested_dissection(graph: &Graph, vertices: &[u32]) -> Vec<u32> {
    let mut number = vec![-1; graph.len()];
    vertices.iter().zip(0..).for_each(|(&vertex, own)| number[vertex as usize] = own);
    let (mut starts, mut neighbours, mut weights) = (vec![0], Vec::new(), Vec::new());
    for &vertex in vertices {
        let others = graph.neighbours(vertex as usize).iter().map(|&other| number[other as usize]);
        neighbours.extend(others.filter(|&other| other >= 0));
        starts.push(neighbours.len() as i32);
        weights.push(graph.weight(vertex as usize) as i32);
    }
    if neighbours.is_empty() {
        return vertices.to_vec();
    }
    // the numbers of METIS have 32 bits: more neighbours would begin at places that wrapped around
    assert!(neighbours.len() <= i32::MAX as usize, "{} neighbours are too many for METIS", neighbours.len());
    let mut count = vertices.len() as i32;
    let (mut order, mut places) = (vec![0; vertices.len()], vec![0; vertices.len()]);
    let mut options = [0; metis_sys::METIS_NOPTIONS as usize];
    let lock = METIS.lock();
    // SAFETY: METIS reads a start for each vertex and one more, as many neighbours as the last start says, all of them numbers of
    // vertices, a weight for each vertex, and its options; it writes a number for each vertex to the last two. All live until
    // it returns, and the lock keeps out another call while it uses what it holds globally.
    let status = unsafe {
        metis_sys::METIS_SetDefaultOptions(options.as_mut_ptr());
        options[metis_sys::moptions_et_METIS_OPTION_SEED as usize] = 1;
        options[metis_sys::moptions_et_METIS_OPTION_COMPRESS as usize] = 0;
        metis_sys::METIS_NodeND(
            &mut count,
            starts.as_mut_ptr(),
            neighbours.as_mut_ptr(),
            weights.as_mut_ptr(),
            options.as_mut_ptr(),
            order.as_mut_ptr(),
            places.as_mut_ptr(),
        )
    };
    drop(lock);
    assert_eq!(status, metis_sys::rstatus_et_METIS_OK, "METIS refused a graph of {count} vertices");
    order.iter().map(|&own| vertices[own as usize]).collect()
}
