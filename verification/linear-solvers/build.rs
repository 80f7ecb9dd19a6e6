//! Compiles what the optional feature `mumps` calls.

fn main() {
    println!("cargo::rerun-if-changed=verification/linear-solvers/build.rs");
    #[cfg(feature = "mumps")]
    {
        const SOURCE: &str = "verification/linear-solvers/mumps.c";
        println!("cargo::rerun-if-changed={SOURCE}");
        cc::Build::new().file(SOURCE).compile("costate_mumps");
        println!("cargo::rustc-link-lib=dmumps_seq");
    }
}
