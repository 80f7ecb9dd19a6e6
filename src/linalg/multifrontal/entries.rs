use super::graph::rows_of;
use super::symbolic::Symbolic;
use crate::linalg::SparsePattern;

/// Entries of the matrix that stand as a block in a front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EntryBlock {
    /// Place of the first entry among the values.
    pub source: u32,
    /// Distance of the columns among the values.
    pub stride: u32,
    /// First row in the front.
    pub row: u32,
    /// First column in the front.
    pub column: u32,
    /// Number of rows.
    pub height: u32,
    /// Number of columns.
    pub width: u32,
}

/// Entries of a column that follow each other both in the pattern and in the order of elimination.
struct Segment {
    /// Number of the first among the entries of the column.
    first: u32,
    /// Place of its row.
    row: u32,
    /// Number of entries.
    length: u32,
    /// The front that eliminates these rows.
    front: u32,
}

/// Divides the entries of a column.
fn find_segments(rows: &[u32], place: &[u32], front_of: &[u32], segments: &mut Vec<Segment>) {
    segments.clear();
    for (first, &row) in (0u32..).zip(rows) {
        let row = place[row as usize];
        let front = front_of[row as usize];
        match segments.last_mut() {
            Some(last) if last.row + last.length == row && last.front == front => last.length += 1,
            _ => segments.push(Segment { first, row, length: 1, front }),
        }
    }
}

/// Blocks by the fronts that own them, which note where theirs stand; rows and columns get their numbers there.
fn by_front(blocks: &[EntryBlock], owners: &[u32], mut local: Vec<u32>, symbolic: &mut Symbolic) -> Vec<EntryBlock> {
    let mut starts = vec![0; symbolic.fronts.len() + 1];
    owners.iter().for_each(|&owner| starts[owner as usize + 1] += 1);
    (0..symbolic.fronts.len()).for_each(|front| starts[front + 1] += starts[front]);
    let mut next = starts.clone();
    let mut sorted = vec![EntryBlock { source: 0, stride: 0, row: 0, column: 0, height: 0, width: 0 }; blocks.len()];
    for (block, &owner) in blocks.iter().zip(owners) {
        sorted[next[owner as usize]] = *block;
        next[owner as usize] += 1;
    }
    for number in 0..symbolic.fronts.len() {
        symbolic.number_rows(&symbolic.fronts[number], &mut local);
        let own = starts[number]..starts[number + 1];
        for block in &mut sorted[own.clone()] {
            block.row = local[block.row as usize];
            block.column = local[block.column as usize];
        }
        symbolic.fronts[number].entries = own;
    }
    sorted
}

/// The entries of a pattern by the front that eliminates their row or their column first.
///
/// Notes in each front where its blocks stand.
pub fn entry_blocks(pattern: &SparsePattern, symbolic: &mut Symbolic) -> Vec<EntryBlock> {
    let mut place = vec![0; symbolic.size];
    symbolic.order.iter().zip(0u32..).for_each(|(&unknown, own)| place[unknown as usize] = own);
    let mut front_of = vec![0u32; symbolic.size];
    for (number, front) in symbolic.fronts.iter().enumerate() {
        let end = front.first + front.pivots;
        front_of[front.first..end].fill(number as u32);
    }

    // rows and columns are numbered by their places until all blocks are known
    let (mut blocks, mut owners) = (Vec::<EntryBlock>::new(), Vec::<u32>::new());
    let mut segments = Vec::<Segment>::new();
    let (mut before, mut current) = (Vec::<usize>::new(), Vec::<usize>::new());
    for (column, &unknown) in symbolic.order.iter().enumerate() {
        let (rows, first) = (rows_of(pattern, unknown as usize), pattern.column_starts[unknown as usize] as u32);
        let new_front = column == 0 || front_of[column] != front_of[column - 1];
        std::mem::swap(&mut before, &mut current);
        current.clear();
        if new_front {
            before.clear();
        }
        if column == 0 || rows_of(pattern, symbolic.order[column - 1] as usize) != rows {
            find_segments(rows, &place, &front_of, &mut segments);
        }
        let mut candidates = before.iter().copied();
        for segment in &segments {
            let source = first + segment.first;
            let owner = segment.front.min(front_of[column]);
            let continued = candidates.next().filter(|&block| {
                let EntryBlock { source: first, stride, row, height, width, .. } = blocks[block];
                let distance = source.wrapping_sub(first);
                let even = if width == 1 { distance < i32::MAX as u32 } else { distance == stride.wrapping_mul(width) };
                even && row == segment.row && height == segment.length && owners[block] == owner
            });
            match continued {
                Some(block) => {
                    if blocks[block].width == 1 {
                        blocks[block].stride = source - blocks[block].source;
                    }
                    blocks[block].width += 1;
                    current.push(block);
                }
                None => {
                    current.push(blocks.len());
                    owners.push(owner);
                    let Segment { row, length: height, .. } = *segment;
                    blocks.push(EntryBlock { source, stride: 0, row, column: column as u32, height, width: 1 });
                }
            }
        }
    }

    by_front(&blocks, &owners, place, symbolic)
}
