use super::CommandLine;
use super::console::print;
use super::failure::Failure;
use clap::Args;
use clap_complete::Shell;
use std::path::PathBuf;

/// Options of `costate completions`.
#[derive(Args)]
pub struct CompletionOptions {
    /// The shell that is to complete
    #[arg(value_enum)]
    shell: Shell,
}

/// Options of `costate man`.
#[derive(Args)]
pub struct ManualOptions {
    /// Folder for the pages, as ~/.local/share/man/man1
    folder: PathBuf,
}

/// `costate completions`: what a shell has to know about commands and options.
pub fn complete(options: &CompletionOptions, program: &CommandLine) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut program.command(), &program.name, &mut text);
    print(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

/// `costate man`: a page of the manual for the program and one for each command.
pub fn write(options: &ManualOptions, program: &CommandLine) -> Result<(), Failure> {
    let ManualOptions { folder } = options;
    let named = |error| Failure::run(format!("man {}: {error}; name a folder that can be written to", folder.display()));
    std::fs::create_dir_all(folder).map_err(named)?;
    clap_mangen::generate_to(program.command(), folder).map_err(named)?;
    print(format_args!("wrote the pages of {} in {}", program.name, folder.display()));
    Ok(())
}
