//! The house of `rust/lib.rs`: each floor uses only those before it.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules in the order of the table in the crate's documentation.
fn floors(root: &Path) -> Vec<String> {
    let text = fs::read_to_string(root.join("lib.rs")).unwrap();
    let names = text.lines().filter_map(|line| line.strip_prefix("//! | ")?.split('`').nth(1));
    names.map(str::to_owned).filter(|name| root.join(format!("{name}.rs")).exists()).collect()
}

/// The file of a module and those of its parts.
fn files(root: &Path, module: &str) -> Vec<PathBuf> {
    let (mut found, mut folders) = (vec![root.join(format!("{module}.rs"))], vec![root.join(module)]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() { folders.push(path) } else { found.push(path) }
        }
    }
    found
}

/// Modules that the code of a file names, apart from its own tests.
fn used(file: &Path) -> Vec<String> {
    let text = fs::read_to_string(file).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let name = |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap().to_owned();
    code.flat_map(|line| line.split("crate::").skip(1).map(name).collect::<Vec<_>>()).collect()
}

#[test]
fn each_floor_uses_only_those_before_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("rust");
    let floors = floors(&root);
    assert!(floors.len() > 30, "{floors:?}");
    let top = floors.len() - 1;
    assert_eq!(floors[top], "python");
    for (floor, module) in floors.iter().enumerate() {
        for file in files(&root, module) {
            for other in used(&file) {
                let place = floors.iter().position(|name| *name == other);
                assert!(place.is_none_or(|place| place <= floor), "{} uses {other}", file.display());
            }
        }
    }
    for entry in fs::read_dir(&root).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        assert!(name == "lib" || floors.contains(&name), "{name} is not in the table");
    }
}
