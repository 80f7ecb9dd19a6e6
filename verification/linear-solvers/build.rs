//! Compiles what the optional feature `mumps` calls, and names its library: that of MPI with the feature `mpi`.

fn main() {
    println!("cargo::rerun-if-changed=verification/linear-solvers/build.rs");
    #[cfg(feature = "mumps")]
    {
        const SOURCE: &str = "src/linalg/mumps.c";
        println!("cargo::rerun-if-changed={SOURCE}");
        let mut build = cc::Build::new();
        if cfg!(feature = "mpi") {
            build.compiler("mpicc").define("COSTATE_MPI", None);
        }
        build.file(SOURCE).compile("costate_mumps");
        println!("cargo::rustc-link-lib={}", if cfg!(feature = "mpi") { "dmumps" } else { "dmumps_seq" });
    }
}
