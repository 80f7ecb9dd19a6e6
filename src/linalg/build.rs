//! Compiles what the optional feature `mumps` calls, and names its library.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "mumps")]
    {
        const SOURCE: &str = "mumps.c";
        println!("cargo::rerun-if-changed={SOURCE}");
        cc::Build::new().compiler("mpicc").file(SOURCE).compile("costate_mumps");
        println!("cargo::rustc-link-lib=dmumps");
    }
}
