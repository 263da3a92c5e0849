//! Sessions in little shared memory: each test has a `/dev/shm` of its own.

use std::{path::PathBuf, process::Command};

use cohabit_record::Log;
use cohabit_tests::run;

use crate::COHABIT;

/// A shell with a small `/dev/shm` of its own.
struct Shell {
    folder: PathBuf,
}

impl Shell {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("cohabit-memory-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self { folder }
    }

    /// Runs a script in which `$0` is the binary and `$1` a folder; whether it ended well, and what was said.
    fn run(&self, size: &str, script: &str) -> (bool, String) {
        let script = format!("mount -t tmpfs -o size={size} tmpfs /dev/shm && {{ {script}\n}}");
        let output = Command::new("unshare")
            .args(["-rm", "sh", "-c", &script, COHABIT])
            .arg(&self.folder)
            .env("XDG_RUNTIME_DIR", &self.folder)
            .env("XDG_DATA_HOME", &self.folder)
            .output();
        let output = output.unwrap();
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    }
}

impl Drop for Shell {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

#[test]
#[cfg_attr(not(mounts), ignore = "optional: the right to mount a file system (`unshare -rm`)")]
fn where_there_is_too_little_no_session_starts_and_the_remedy_is_told() {
    let shell = Shell::new("little");
    let (well, said) = shell.run("8m", "\"$0\" play --port 0; test $? = 4 && test -z \"$(ls /dev/shm)\"");
    assert!(well && said.contains("/dev/shm has 8.0 MiB free") && said.contains("remount,size="), "{said}");
}

#[test]
#[cfg_attr(not(mounts), ignore = "optional: the right to mount a file system (`unshare -rm`)")]
fn when_it_fills_up_the_session_ends_with_a_reason_and_its_log() {
    let shell = Shell::new("full");
    // All that is free is taken; then somebody must be started again, for whom there is no room.
    let script = r#"
        "$0" play cold_soda --port 0 --session full --log "$1/log.mcap" > "$1/said" 2>&1 &
        play=$!
        until grep -q Open "$1/said"; do kill -0 $play || exit 3; sleep 0.1; done
        cat /dev/zero > /dev/shm/other 2> /dev/null
        for process in $(cat /proc/$play/task/*/children); do
            tr '\0' ' ' < /proc/$process/cmdline | grep -q " dialog --session" && kill -KILL $process
        done
        wait $play; code=$?
        cat "$1/said"
        test $code = 1 && test "$(ls /dev/shm)" = other
    "#;
    let (well, said) = shell.run("40m", script);
    assert!(well && said.contains("/dev/shm is full"), "{said}");
    let path = shell.folder.join("log.mcap");
    let log = Log::open(&path).unwrap();
    assert_eq!((log.cut.as_deref(), log.missing()), (None, 0));
    let replayed = run(COHABIT, &["replay", path.to_str().unwrap()]).unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
}
