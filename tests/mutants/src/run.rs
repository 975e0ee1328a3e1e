//! Tests in processes of their own: what each reaches, and which mutants they notice.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A test binary, and where it runs.
pub struct Binary {
    pub path: PathBuf,
    pub folder: PathBuf,
}

/// A test, and what it takes when nothing is changed.
pub struct Test {
    pub name: String,
    pub seconds: f64,
    /// The first mutants of the points that it reaches.
    pub reaches: Vec<u32>,
}

/// What came of a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A test failed.
    Caught(String),
    /// A test took too long.
    TimedOut(String),
    /// No test of the part failed.
    Missed,
    /// No test of the part comes by.
    Unreached,
}

/// How one run of one test ended.
#[derive(PartialEq)]
enum End {
    Passed,
    Failed,
    TimedOut,
}

/// What a test may take of memory, in KiB: a mutant may ask for all there is.
const MEMORY: usize = 6 << 20;

impl Binary {
    /// The names of all tests, in order.
    pub fn tests(&self) -> Result<Vec<String>, String> {
        let output = Command::new(&self.path)
            .args(["--list", "--format", "terse"])
            .current_dir(&self.folder)
            .output()
            .map_err(|error| format!("{}: {error}", self.path.display()))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        Ok(text.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
    }

    fn run(&self, test: &str, variable: (&str, &str), limit: Duration) -> End {
        // Limits of processor time and memory are the shell's; the wall clock only ends what waits.
        let shell = format!("ulimit -v {MEMORY}; ulimit -t {}; exec \"$@\"", limit.as_secs() + 1);
        let child = Command::new("sh")
            .args(["-c", &shell, "sh"])
            .arg(&self.path)
            .args(["--exact", test, "--test-threads=1"])
            .current_dir(&self.folder)
            .env(variable.0, variable.1)
            .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("PROPTEST_RNG_SEED", "1")
            .env("INSTA_UPDATE", "no")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut child) = child else { return End::Failed };
        let start = Instant::now();
        let mut pause = Duration::from_micros(500);
        loop {
            match child.try_wait() {
                Ok(Some(status)) if status.success() => return End::Passed,
                Ok(Some(status)) => {
                    use std::os::unix::process::ExitStatusExt;
                    // SIGXCPU, or the SIGKILL that follows it.
                    let is_late = matches!(status.signal(), Some(24 | 9));
                    return if is_late { End::TimedOut } else { End::Failed };
                }
                Ok(None) if start.elapsed() > 4 * limit => {
                    let _ = child.kill();
                    let _ = child.wait();
                    return End::TimedOut;
                }
                Ok(None) => {
                    std::thread::sleep(pause);
                    pause = (pause * 3 / 2).min(Duration::from_millis(20));
                }
                Err(_) => return End::Failed,
            }
        }
    }

    /// Runs each test with no mutant, and notes what it reaches; one that takes longer than `slowest` is ended.
    /// Returns the tests, and those that fail or are too slow. What an earlier run of the same binary noted in
    /// `folder` is taken from there: `state` is a hash of the binary.
    pub fn trace(
        &self,
        names: &[String],
        workers: usize,
        folder: &Path,
        state: u64,
        slowest: Duration,
    ) -> Result<(Vec<Test>, Vec<String>), String> {
        let kept = folder.join("trace.tsv");
        let head = format!("{state:x}");
        let old = fs::read_to_string(&kept).unwrap_or_default();
        let mut known: HashMap<&str, &str> = HashMap::new();
        if old.lines().next() == Some(&head) {
            known.extend(old.lines().skip(1).filter_map(|line| line.split_once('\t')));
        }
        let lines = each(names.len(), workers, |index| {
            if let Some(line) = known.get(names[index].as_str()) {
                return (*line).to_owned();
            }
            let file = folder.join(format!("trace-{index}"));
            let _ = fs::remove_file(&file);
            let start = Instant::now();
            let end = self.run(&names[index], ("UMBRAGE_MUTANT_TRACE", &file.to_string_lossy()), slowest);
            let seconds = start.elapsed().as_secs_f64();
            let bytes = fs::read(&file).unwrap_or_default();
            let _ = fs::remove_file(&file);
            let reached = bytes
                .chunks_exact(4)
                .map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]).to_string())
                .collect::<Vec<_>>()
                .join(" ");
            let end = if end == End::Passed { "passed" } else { "left out" };
            format!("{end}\t{seconds}\t{reached}")
        });
        let mut text = head + "\n";
        let (mut tests, mut left_out) = (Vec::new(), Vec::new());
        for (name, line) in names.iter().zip(lines) {
            text += &format!("{name}\t{line}\n");
            let fields = line.split('\t').collect::<Vec<_>>();
            let [end, seconds, reached] = fields[..] else { return Err(format!("not a trace: {line}")) };
            if end == "passed" {
                tests.push(Test {
                    name: name.clone(),
                    seconds: seconds.parse().map_err(|_| format!("not a trace: {line}"))?,
                    reaches: reached.split_whitespace().filter_map(|number| number.parse().ok()).collect(),
                });
            } else {
                left_out.push(name.clone());
            }
        }
        fs::write(&kept, text).map_err(|error| format!("{}: {error}", kept.display()))?;
        Ok((tests, left_out))
    }

    /// Runs `tests` with a mutant until one notices it.
    pub fn judge(&self, mutant: u32, tests: &[&Test]) -> Outcome {
        if tests.is_empty() {
            return Outcome::Unreached;
        }
        for test in tests {
            let limit = Duration::from_secs_f64(10.0 * test.seconds + 2.0);
            match self.run(&test.name, ("UMBRAGE_MUTANT", &mutant.to_string()), limit) {
                End::Passed => {}
                End::Failed => return Outcome::Caught(test.name.clone()),
                End::TimedOut => return Outcome::TimedOut(test.name.clone()),
            }
        }
        Outcome::Missed
    }
}

/// The tests that reach each point, quickest first.
pub fn by_point(tests: &[Test]) -> HashMap<u32, Vec<&Test>> {
    let mut order = tests.iter().collect::<Vec<_>>();
    order.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut all: HashMap<u32, Vec<&Test>> = HashMap::new();
    for test in order {
        for &point in &test.reaches {
            all.entry(point).or_default().push(test);
        }
    }
    all
}

/// `work` of `0..count` on several threads; results in order.
pub fn each<T: Send>(count: usize, workers: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        return;
                    }
                    let result = work(index);
                    done.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((index, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}
