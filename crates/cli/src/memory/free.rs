//! How much memory can be had: of the machine, and of the control groups that this process is in, as those of
//! containers. Known on Linux only.

use std::fs::read_to_string;
use std::path::Path;

/// Limits from here on are none: version 1 says "no limit" by a number of about 2^63.
const NO_LIMIT: u64 = 1 << 60;

/// Where things lie below the root of the file system.
const MEMINFO: &str = "proc/meminfo";
const OWN_GROUPS: &str = "proc/self/cgroup";
const VERSION_2: &str = "sys/fs/cgroup";
const VERSION_1: &str = "sys/fs/cgroup/memory";

/// The files of a version, by what they tell.
struct Names {
    limit: &'static str,
    used: &'static str,
    /// Of memory, and of memory with swap; or of swap alone.
    swap_limit: &'static str,
    swap_used: &'static str,
    swap_is_alone: bool,
    /// Pages of files that may be dropped at any time, which count as used.
    droppable: &'static str,
}

const NAMES_2: Names = Names {
    limit: "memory.max",
    used: "memory.current",
    swap_limit: "memory.swap.max",
    swap_used: "memory.swap.current",
    swap_is_alone: true,
    droppable: "inactive_file ",
};

const NAMES_1: Names = Names {
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    swap_limit: "memory.memsw.limit_in_bytes",
    swap_used: "memory.memsw.usage_in_bytes",
    swap_is_alone: false,
    droppable: "total_inactive_file ",
};

/// Memory that can be had without pushing other programs out, and free swap, in bytes. `root` is that of the file
/// system.
pub(super) fn free_bytes(root: &Path) -> Option<u64> {
    let of = |key| kibibytes_of(&root.join(MEMINFO), key);
    let (memory, swap) = (of("MemAvailable:")?, of("SwapFree:").unwrap_or(0));
    Some(of_groups(root, swap).map_or(memory + swap, |free| free.min(memory + swap)))
}

/// What a file tells in the line `key 123 kB`, in bytes; Linux writes kB for 1024 bytes. `None` without such a line.
pub(super) fn kibibytes_of(file: &Path, key: &str) -> Option<u64> {
    let text = read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The least that any group leaves that this process is in; `None` without limits.
fn of_groups(root: &Path, swap: u64) -> Option<u64> {
    let groups = read_to_string(root.join(OWN_GROUPS)).ok()?;
    let of_line = |line: &str| {
        // Number of a hierarchy, its controllers, path.
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next()?, fields.next()?);
        let (folder, names) = match controllers {
            "" => (VERSION_2, &NAMES_2),
            _ if controllers.split(',').any(|name| name == "memory") => (VERSION_1, &NAMES_1),
            _ => return None,
        };
        let top = root.join(folder);
        let own = top.join(path.trim_start_matches('/'));
        // Seen from within a container its own group may be the top, whatever the path says.
        let all = own.ancestors().take_while(|folder| folder.starts_with(&top)).map(Path::to_path_buf);
        all.filter_map(|folder| left_in(&folder, names, swap)).min()
    };
    groups.lines().filter_map(of_line).min()
}

/// What a group leaves, in bytes; `None` if it has no limit.
fn left_in(folder: &Path, names: &Names, swap: u64) -> Option<u64> {
    let number = |name: &str| read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
    let limit_of = |name: &str| number(name).filter(|&limit| limit < NO_LIMIT);
    let droppable = droppable(&folder.join("memory.stat"), names.droppable);
    let used = number(names.used)?.saturating_sub(droppable);
    let memory = limit_of(names.limit)?.saturating_sub(used);
    let swap_left = |limit: u64| limit.saturating_sub(number(names.swap_used).unwrap_or(0));
    Some(match limit_of(names.swap_limit).map(swap_left) {
        None => memory.saturating_add(swap),
        Some(left) if names.swap_is_alone => memory.saturating_add(left.min(swap)),
        Some(left) => memory.saturating_add(swap).min(left.saturating_add(droppable)),
    })
}

fn droppable(file: &Path, key: &str) -> u64 {
    let text = read_to_string(file).unwrap_or_default();
    text.lines().find_map(|line| line.strip_prefix(key)?.trim().parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    /// A file system with 1000 MiB available, 100 MiB of free swap, and these files.
    fn root(files: &[(&str, String)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let meminfo = "MemTotal: 4096000 kB\nMemAvailable: 1024000 kB\nSwapFree: 102400 kB\n".to_owned();
        for (name, text) in [(MEMINFO, meminfo)].iter().chain(files) {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        root
    }

    fn free_of(files: &[(&str, String)]) -> Option<u64> {
        free_bytes(root(files).path()).map(|bytes| bytes / MIB)
    }

    fn mebibytes(count: u64) -> String {
        format!("{}\n", count * MIB)
    }

    #[test]
    fn without_groups_it_is_the_machines() {
        assert_eq!(free_of(&[]), Some(1100));
        assert_eq!(free_of(&[(OWN_GROUPS, "0::/\n".to_owned())]), Some(1100));
        assert_eq!(free_bytes(Path::new("/nowhere")), None);
    }

    #[test]
    fn a_container_has_less() {
        let own = |text: &str| (OWN_GROUPS, text.to_owned());
        let (max, current) = ("sys/fs/cgroup/memory.max", "sys/fs/cgroup/memory.current");
        let swap = ("sys/fs/cgroup/memory.swap.max", "0\n".to_owned());
        let files = [own("0::/\n"), (max, mebibytes(512)), (current, mebibytes(200)), swap];
        assert_eq!(free_of(&files), Some(312));
        // Half of what is used may be dropped.
        let stat = ("sys/fs/cgroup/memory.stat", format!("anon 1\ninactive_file {}\n", 100 * MIB));
        assert_eq!(free_of(&[&files[..], &[stat]].concat()), Some(412));
        // Without a limit of swap all of the machine's counts; a path that is not there is the container's own.
        let files = [own("0::/docker/0123\n"), (max, mebibytes(512)), (current, mebibytes(200))];
        assert_eq!(free_of(&files), Some(412));
        let files = [own("0::/\n"), (max, "max\n".to_owned()), (current, mebibytes(200))];
        assert_eq!(free_of(&files), Some(1100));
    }

    #[test]
    fn the_narrowest_of_nested_groups_counts() {
        let files = [
            (OWN_GROUPS, "0::/a/b\n".to_owned()),
            ("sys/fs/cgroup/a/memory.max", mebibytes(300)),
            ("sys/fs/cgroup/a/memory.current", mebibytes(250)),
            ("sys/fs/cgroup/a/memory.swap.max", mebibytes(0)),
            ("sys/fs/cgroup/a/b/memory.max", mebibytes(900)),
            ("sys/fs/cgroup/a/b/memory.current", mebibytes(10)),
        ];
        assert_eq!(free_of(&files), Some(50));
    }

    #[test]
    fn version_1_tells_memory_and_swap_together() {
        let top = "sys/fs/cgroup/memory/";
        let file = |name: &str, text: String| (format!("{top}{name}"), text);
        let none = format!("{}\n", i64::MAX as u64 / 4096 * 4096);
        let with = |limit: String, swap: String| {
            let files = [
                (OWN_GROUPS.to_owned(), "5:cpu,memory:/\n1:name=systemd:/x\n".to_owned()),
                file("memory.limit_in_bytes", limit),
                file("memory.usage_in_bytes", mebibytes(100)),
                file("memory.memsw.limit_in_bytes", swap),
                file("memory.memsw.usage_in_bytes", mebibytes(150)),
                file("memory.stat", format!("total_inactive_file {}\n", 20 * MIB)),
            ];
            free_of(&files.iter().map(|(name, text)| (&name[..], text.clone())).collect::<Vec<_>>())
        };
        assert_eq!(with(none.clone(), none.clone()), Some(1100));
        assert_eq!(with(mebibytes(400), none), Some(420));
        assert_eq!(with(mebibytes(400), mebibytes(400)), Some(270));
    }
}
