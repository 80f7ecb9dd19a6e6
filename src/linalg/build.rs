//! Compiles what the optional feature `mumps` calls, and names its library.

fn main() {
    println!("cargo::rerun-if-changed=src/linalg/build.rs");
    #[cfg(feature = "mumps")]
    {
        const SOURCE: &str = "src/linalg/mumps.c";
        println!("cargo::rerun-if-changed={SOURCE}");
        cc::Build::new().compiler("mpicc").file(SOURCE).compile("costate_mumps");
        println!("cargo::rustc-link-lib=dmumps");
    }
}
