#[path = "../verification/mod.rs"]
mod verification;

fn main() {
    let _ = verification::all();
}
