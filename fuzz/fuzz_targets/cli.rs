#![no_main]

// The command's own parser: nothing that it asks for is run.
#[expect(dead_code, reason = "what the arguments ask for is not done here")]
#[path = "../../src/cli/mod.rs"]
mod cli;

use umbrage_fuzz::command;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    umbrage_fuzz::run("cli", data);
    let arguments = std::iter::once("umbrage".to_owned()).chain(command::arguments(data));
    if let Err(error) = cli::parse(arguments.map(Into::into))
        && error.use_stderr()
    {
        command::is_one_line(&cli::usage(&error.to_string()).to_string());
    }
});
