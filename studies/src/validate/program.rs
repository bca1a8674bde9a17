//! The program: building it, running it, reading its results.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use tempfile::TempDir;

/// Exit code of the program after Ctrl-C.
const INTERRUPTED: i32 = 130;

/// A temporary folder with built programs and the folders of their runs.
pub(crate) struct Workshop {
    root: PathBuf,
    folder: TempDir,
}

/// A built program, copied to a place where later builds do not replace it.
pub(crate) struct Program {
    path: PathBuf,
}

/// The summary of a finished run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Summary(Value);

impl Workshop {
    /// # Errors
    /// When no temporary folder can be made.
    pub(crate) fn new(root: &Path) -> Result<Self> {
        Ok(Self {
            root: root.to_owned(),
            folder: tempfile::tempdir().context("cannot make a temporary folder")?,
        })
    }

    /// The root of the workspace.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// Builds the release program with more options for cargo.
    ///
    /// # Errors
    /// When the build fails.
    pub(crate) fn build(&self, name: &str, options: &[&str]) -> Result<Program> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(["build", "--release", "--locked", "--package", "femdem"])
            .args(["--message-format", "json-render-diagnostics"])
            .args(options)
            .current_dir(&self.root)
            .stdin(Stdio::null())
            .stderr(Stdio::inherit())
            .output()
            .context("cannot start cargo")?;
        ensure!(output.status.success(), "the release build failed");
        let built = executable(&String::from_utf8_lossy(&output.stdout))
            .context("cargo did not say where it put the program")?;
        let path = self.folder.path().join(name);
        fs::copy(&built, &path).with_context(|| format!("cannot copy {}", built.display()))?;
        Ok(Program { path })
    }

    /// Writes a file for the runs and returns its path.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf> {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(path)
    }

    /// A copy of a file under another name; returns its path.
    ///
    /// # Errors
    /// When it cannot be copied.
    pub(crate) fn named(&self, file: &Path, name: &str) -> Result<PathBuf> {
        let path = self.folder.path().join(name);
        fs::copy(file, &path).with_context(|| format!("cannot copy {}", file.display()))?;
        Ok(path)
    }

    /// The folder of a run.
    pub(crate) fn results(&self, name: &str) -> PathBuf {
        self.folder.path().join("runs").join(name)
    }
}

/// The path of the program in cargo's messages, one JSON object to a line.
fn executable(messages: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter(|message| message["target"]["name"] == "femdem")
        .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
        .next_back()
}

impl Program {
    /// Runs `femdem pack` with `options` to its end, and reads the summary.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn pack(&self, options: &str, folder: &Path) -> Result<Summary> {
        self.finish("pack", options, &["--out".into(), folder.into()])?;
        Summary::read(folder)
    }

    /// Runs a scene by `femdem run`.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn scene(&self, scene: &Path, options: &str, folder: &Path) -> Result<()> {
        let files = [scene.into(), "--out".into(), folder.into()];
        self.finish("run", options, &files)
    }

    /// Measures the pack in a folder into another, by `femdem analyse` or `femdem report`.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn measure(
        &self,
        command: &str,
        folder: &Path,
        options: &str,
        out: &Path,
    ) -> Result<()> {
        let folders = [folder.into(), "--out".into(), out.into()];
        self.finish(command, options, &folders)
    }

    /// The output of a command.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn output(&self, command: &str, options: &str) -> Result<String> {
        let output = self.command(command, options, &[]).output();
        let output = output.context("cannot start the program")?;
        ensure!(
            output.status.success(),
            "femdem {command} {options} ended with {}: {}",
            output.status,
            String::from_utf8_lossy(&output.stderr).trim()
        );
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// A picture of the bodies listed in a folder, by `femdem picture`; returns its path.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn picture(&self, folder: &Path, picture: &Path) -> Result<PathBuf> {
        let arguments = [folder.into(), "--out".into(), picture.into()];
        self.finish("picture", "", &arguments)?;
        Ok(picture.to_owned())
    }

    /// Continues the run in a folder to its end, and reads the summary.
    ///
    /// # Errors
    /// When the program fails.
    pub(crate) fn resume(&self, options: &str, folder: &Path) -> Result<Summary> {
        self.finish("resume", options, &[folder.into()])?;
        Summary::read(folder)
    }

    /// Starts `femdem pack` and sends it Ctrl-C after a time.
    ///
    /// # Errors
    /// When the program has finished before, or does not stop as it should.
    pub(crate) fn pack_interrupted(
        &self,
        options: &str,
        folder: &Path,
        after: std::time::Duration,
    ) -> Result<()> {
        let mut child = self
            .command("pack", options, &["--out".into(), folder.into()])
            .spawn()
            .context("cannot start the program")?;
        std::thread::sleep(after);
        if let Some(status) = child.try_wait().context("cannot watch the program")? {
            bail!("the run ended ({status}) before it was interrupted: give more bodies");
        }
        interrupt(&child)?;
        let status = child.wait().context("cannot wait for the program")?;
        ensure!(
            status.code() == Some(INTERRUPTED),
            "the interrupted program ended with {status}, not with exit code {INTERRUPTED}"
        );
        Ok(())
    }

    fn finish(&self, command: &str, options: &str, more: &[OsString]) -> Result<()> {
        println!("femdem {command} {}", options.trim_end());
        let status = self.command(command, options, more).status();
        let status = status.context("cannot start the program")?;
        ensure!(
            status.success(),
            "femdem {command} {options} ended with {status}"
        );
        Ok(())
    }

    fn command(&self, command: &str, options: &str, more: &[OsString]) -> Command {
        let mut run = Command::new(&self.path);
        run.arg(command)
            .args(options.split_whitespace())
            .arg("--quiet")
            .args(more)
            .stdin(Stdio::null());
        run
    }
}

/// Sends the signal of Ctrl-C.
fn interrupt(child: &Child) -> Result<()> {
    let status = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .context("cannot start kill: this case needs a Unix system")?;
    ensure!(status.success(), "kill -INT failed");
    Ok(())
}

impl Summary {
    /// The summary in a folder.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(crate) fn read(folder: &Path) -> Result<Self> {
        let path = folder.join("summary.json");
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Self::parse(&text)
    }

    /// # Errors
    /// When the text is not JSON.
    pub(crate) fn parse(text: &str) -> Result<Self> {
        Ok(Self(
            serde_json::from_str(text).context("the summary is not JSON")?,
        ))
    }

    /// A number by its path, such as "residual.max_over_weight".
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn number(&self, path: &str) -> Result<f64> {
        self.at(path)
            .as_f64()
            .with_context(|| format!("the summary has no number {path}"))
    }

    /// The state hash.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn hash(&self) -> Result<String> {
        let hash = self.at("state_hash").as_str();
        Ok(hash.context("the summary has no state_hash")?.to_owned())
    }

    pub(crate) fn is_settled(&self) -> bool {
        self.at("settled") == &Value::Bool(true)
    }

    fn at(&self, path: &str) -> &Value {
        path.split('.').fold(&self.0, |value, key| &value[key])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_is_found_among_cargos_messages() {
        let messages = concat!(
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"femdem\"},\"executable\":null}\n",
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"other\"},\"executable\":\"/t/other\"}\n",
            "no json\n",
            "{\"reason\":\"compiler-artifact\",\"target\":{\"name\":\"femdem\"},\"executable\":\"/t/femdem\"}\n",
            "{\"reason\":\"build-finished\",\"success\":true}\n",
        );
        assert_eq!(executable(messages), Some(PathBuf::from("/t/femdem")));
        assert_eq!(executable(""), None);
    }

    #[test]
    fn summaries_are_read_by_path() {
        let text = r#"{"settled": true, "state_hash": "ab", "cpu_seconds": null,
                       "residual": {"max_over_weight": 0.01}}"#;
        let summary = Summary::parse(text).unwrap();
        assert_eq!(summary.number("residual.max_over_weight").unwrap(), 0.01);
        assert_eq!(summary.hash().unwrap(), "ab");
        assert!(summary.is_settled());
        let error = summary.number("cpu_seconds").unwrap_err().to_string();
        assert!(error.contains("cpu_seconds"));
        assert!(!Summary::parse("{}").unwrap().is_settled());
        assert!(Summary::parse("{").is_err());
    }
}
