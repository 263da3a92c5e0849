//! Worker processes: tasks go out and results come back as lines of JSON.
//!
//! A worker that dies takes one task with it, and is replaced. A worker whose master dies reads the end of its input,
//! and ends.

use std::{
    io::{self, BufRead, BufReader, Write},
    process::{Child, ChildStdin, Command, Stdio},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use serde::Serialize;

use crate::{play::Played, task::Task};

/// Why workers could not be run.
#[derive(Debug, thiserror::Error)]
#[error("start a worker process: {0}")]
pub struct PoolError(#[from] io::Error);

/// Has tasks played by `workers` processes, each started by `start`; `done` is told whenever one was.
///
/// A result is `Err` where a worker died or answered nonsense: with what is known about that.
///
/// # Errors
/// [`PoolError`], when no process can be started.
pub fn run(
    tasks: &[Task],
    workers: usize,
    start: &(dyn Fn() -> Command + Sync),
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Result<Played, String>>, PoolError> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(tasks.iter().map(|_| None).collect::<Vec<_>>());
    let work = || -> Result<(), PoolError> {
        let mut worker: Option<Worker> = None;
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(number) else { return Ok(()) };
            let mut running = match worker.take() {
                Some(running) => running,
                None => Worker::start(start())?,
            };
            let result = running.play(task);
            done();
            if result.is_ok() {
                worker = Some(running);
            }
            results.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(result);
        }
    };
    thread::scope(|scope| {
        let handles: Vec<_> = (0..workers.clamp(1, tasks.len().max(1))).map(|_| scope.spawn(work)).collect();
        let joined =
            handles.into_iter().map(|handle| handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        joined.collect::<Vec<_>>().into_iter().collect::<Result<(), _>>()
    })?;
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(results.into_iter().map(|result| result.unwrap_or_else(|| Err("it was not played".to_owned()))).collect())
}

struct Worker {
    child: Child,
    input: ChildStdin,
    output: BufReader<std::process::ChildStdout>,
}

impl Worker {
    fn start(mut command: Command) -> io::Result<Self> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let missing = || io::Error::other("it has no pipes");
        let input = child.stdin.take().ok_or_else(missing)?;
        let output = BufReader::new(child.stdout.take().ok_or_else(missing)?);
        Ok(Self { child, input, output })
    }

    fn play(&mut self, task: &Task) -> Result<Played, String> {
        let asked = write_line(&mut self.input, task);
        let mut line = String::new();
        let answered = asked.and_then(|()| self.output.read_line(&mut line));
        match answered {
            Ok(1..) => serde_json::from_str(&line).map_err(|error| format!("its worker answered nonsense: {error}")),
            Ok(0) | Err(_) => Err(match self.child.wait() {
                Ok(status) => format!("its worker died ({status})"),
                Err(error) => format!("its worker is lost: {error}"),
            }),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Its input ends with this struct; but one that hangs would keep us for ever.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The other side: plays what is asked for on the input, until it ends.
///
/// # Errors
/// When the master's pipes fail, or a log cannot be written.
pub fn serve(
    input: impl BufRead,
    mut output: impl Write,
    mut play: impl FnMut(&Task) -> Result<Played, io::Error>,
) -> io::Result<()> {
    for line in input.lines() {
        let played = play(&serde_json::from_str(&line?)?)?;
        write_line(&mut output, &played)?;
    }
    Ok(())
}

fn write_line(output: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *output, value)?;
    writeln!(output)?;
    output.flush()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    fn task(id: usize) -> Task {
        Task { id: id.to_string(), family: None, cdf: String::new(), preparation: Vec::new(), script: Vec::new() }
    }

    #[test]
    fn a_worker_that_dies_takes_one_task_with_it() {
        let played = serde_json::to_string(&Played::default()).unwrap();
        // It dies of task 2, and talks nonsense about task 4.
        let script = format!(
            r#"while read task; do case $task in *:'"2"'*) exit 9;; *:'"4"'*) echo nonsense;; *) echo '{played}';; esac; done"#
        );
        let tasks: Vec<Task> = (0..6).map(task).collect();
        let results = run(&tasks, 2, &|| shell(&script), &|| {}).unwrap();
        let failed: Vec<usize> = (0..6).filter(|task| results[*task].is_err()).collect();
        assert_eq!(failed, [2, 4]);
        assert!(results[2].as_ref().unwrap_err().contains("exit status: 9"), "{:?}", results[2]);
        assert!(run(&tasks, 1, &|| Command::new("/nowhere/cohabit"), &|| {}).is_err());
    }

    #[test]
    fn a_worker_serves_until_its_input_ends() {
        let mut output = Vec::new();
        let play = |task: &Task| Ok(Played { id: task.id.clone(), ..Played::default() });
        let asked: Vec<String> = [3, 1].map(|id| serde_json::to_string(&task(id)).unwrap()).to_vec();
        serve(asked.join("\n").as_bytes(), &mut output, play).unwrap();
        let ids: Vec<String> = String::from_utf8(output)
            .unwrap()
            .lines()
            .map(|line| serde_json::from_str::<Played>(line).unwrap().id)
            .collect();
        assert_eq!(ids, ["3", "1"]);
    }
}
