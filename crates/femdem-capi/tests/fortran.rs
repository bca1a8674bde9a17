//! The module of Fortran is made of the header: its constants, types and functions, in its order.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const START: &str = "\
! femdem for Fortran 2018: the constants, types and functions of femdem.h, where they are described. Texts end with c_null_char. A
! number of C without sign is one with a sign here. Made of the header by tests/fortran.rs: do not edit.
module femdem
  use, intrinsic :: iso_c_binding
  implicit none
  public

";

const END: &str = "
    pure function femdem_length(text) bind(c, name=\"strlen\") result(length)
      import
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function
  end interface

contains

  ! The message of the last call of this thread that failed.
  function femdem_message() result(message)
    character(:), allocatable :: message
    character(kind=c_char), pointer :: bytes(:)
    type(c_ptr) :: text
    integer :: k
    text = femdem_last_error()
    call c_f_pointer(text, bytes, [femdem_length(text)])
    allocate(character(size(bytes)) :: message)
    do k = 1, size(bytes)
      message(k:k) = bytes(k)
    end do
  end function
end module
";

/// Pointers that may be null.
const OPTIONAL: [(&str, &str); 8] = [
    ("femdem_batch_set_law", "law"),
    ("femdem_batch_add_box", "sides"),
    ("femdem_batch_slots", "bodies"),
    ("femdem_batch_slots", "walls"),
    ("femdem_world_set_law", "law"),
    ("femdem_world_add_box", "sides"),
    ("femdem_world_drive_body", "drive"),
    ("femdem_world_add_deformable", "fracture"),
];

/// FemdemShape is femdem_shape_t.
fn type_of(name: &str) -> String {
    match name {
        "double" => "real(c_double)".to_owned(),
        "char" => "character(kind=c_char)".to_owned(),
        "size_t" => "integer(c_size_t)".to_owned(),
        "uint8_t" => "integer(c_int8_t)".to_owned(),
        "int32_t" | "uint32_t" => "integer(c_int32_t)".to_owned(),
        "int64_t" | "uint64_t" => "integer(c_int64_t)".to_owned(),
        "FemdemStatus" => "integer(c_int)".to_owned(),
        _ => {
            assert!(name.starts_with("Femdem"), "unknown type {name}");
            let mut own = String::new();
            for c in name.chars() {
                if c.is_uppercase() && !own.is_empty() {
                    own.push('_');
                }
                own.extend(c.to_lowercase());
            }
            format!("type({own}_t)")
        }
    }
}

/// The header without its comments.
fn code(header: &str) -> String {
    let mut parts = header.split("/*");
    let mut code = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        code.push_str(part.split_once("*/").unwrap().1);
    }
    let bare = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    bare.collect::<Vec<_>>().join("\n")
}

fn constants(code: &str, to: &mut String) {
    for line in code.lines() {
        let line = line.trim().trim_end_matches(',');
        let (kind, name, value) = if let Some((name, value)) = line.split_once(" = ") {
            ("c_int", name, value)
        } else if let Some((name, value)) = line
            .strip_prefix("#define ")
            .and_then(|rest| rest.split_once(' '))
        {
            ("c_int32_t", name, value)
        } else {
            continue;
        };
        writeln!(to, "  integer({kind}), parameter :: {name} = {value}").unwrap();
    }
}

fn types(code: &str, to: &mut String) {
    let mut waiting: Vec<(&str, &str)> = code
        .split("typedef struct {")
        .skip(1)
        .map(|part| {
            let (fields, rest) = part.split_once('}').unwrap();
            (rest.split(';').next().unwrap().trim(), fields)
        })
        .collect();
    // In C a type may be used before a pointer to it says what it is; here parts come first.
    while !waiting.is_empty() {
        let names: Vec<&str> = waiting.iter().map(|(name, _)| *name).collect();
        let is_ready = |fields: &str| !fields.split_whitespace().any(|word| names.contains(&word));
        let ready = waiting
            .iter()
            .position(|(_, fields)| is_ready(fields))
            .unwrap();
        let (name, fields) = waiting.remove(ready);
        let own = type_of(name);
        writeln!(to, "\n  type, bind(c) :: {}", &own[5..own.len() - 1]).unwrap();
        for field in fields
            .split(';')
            .map(str::trim)
            .filter(|field| !field.is_empty())
        {
            let (kind, name) = field.split_once(' ').unwrap();
            let name = name.replace('[', "(").replace(']', ")");
            let start = match kind {
                // Not turned.
                _ if name == "rotation(4)" => " = [1d0, 0d0, 0d0, 0d0]",
                "double" => " = 0d0",
                _ if kind.starts_with("Femdem") => "",
                _ => " = 0",
            };
            writeln!(to, "    {} :: {name}{start}", type_of(kind)).unwrap();
        }
        to.push_str("  end type\n");
    }
}

fn functions(code: &str, to: &mut String) {
    let body = code.split("extern \"C\" {").nth(1).unwrap();
    for function in body.split(';').filter(|part| part.contains('(')) {
        let function = function.rsplit("#endif").next().unwrap();
        let (head, arguments) = function
            .trim_end()
            .trim_end_matches(')')
            .split_once('(')
            .unwrap();
        let (result, name) = head.rsplit_once([' ', '*']).unwrap();
        let arguments: Vec<Vec<&str>> = match arguments {
            "void" => Vec::new(),
            all => all
                .split(',')
                .map(|one| one.split_whitespace().collect())
                .collect(),
        };
        let names = arguments
            .iter()
            .map(|words| words.last().unwrap().trim_start_matches('*'));
        let names: Vec<&str> = names.collect();
        let list = names.join(", ");
        let tail = "bind(c) result(answer)";
        writeln!(
            to,
            "\n    function {}({list}) &\n        {tail}\n      import",
            name.trim()
        )
        .unwrap();
        for (k, words) in arguments.iter().enumerate() {
            let is_constant = words[0] == "const";
            let kind = words[usize::from(is_constant)];
            let is_pointer = words.last().unwrap().starts_with('*');
            // An array is followed by its length.
            let next = arguments.get(k + 1).map(|words| words.as_slice());
            let is_list = is_pointer
                && (kind == "char" || matches!(next, Some(["size_t", n]) if !n.starts_with('*')));
            let passing = match (is_pointer, is_constant, is_list) {
                (false, ..) => "value",
                (true, true, _) => "intent(in)",
                (true, false, true) => "intent(inout)",
                (true, false, false) => "intent(out)",
            };
            let optional = if OPTIONAL.contains(&(name.trim(), names[k])) {
                ", optional"
            } else {
                ""
            };
            let shape = if is_list { "(*)" } else { "" };
            writeln!(
                to,
                "      {}, {passing}{optional} :: {}{shape}",
                type_of(kind),
                names[k]
            )
            .unwrap();
        }
        let answer = match result.trim() {
            "const char" => "type(c_ptr)".to_owned(),
            result => type_of(result),
        };
        writeln!(to, "      {answer} :: answer\n    end function").unwrap();
    }
}

/// With WRITE_DOCS set it is written.
#[test]
fn the_module_is_that_of_the_header() {
    let header = code(&crate::header::header());
    let mut wanted = START.to_owned();
    constants(&header, &mut wanted);
    types(&header, &mut wanted);
    wanted.push_str("\n  interface");
    functions(&header, &mut wanted);
    wanted.push_str(END);
    assert!(
        wanted.lines().all(|line| line.len() <= 132),
        "longer than Fortran allows"
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path: PathBuf = folder.join("include").join("femdem.f90");
    if std::env::var_os("WRITE_DOCS").is_some() {
        fs::write(&path, &wanted).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == wanted,
        "include/femdem.f90 is stale: WRITE_DOCS=1 cargo test -p femdem-capi --test all"
    );
}
