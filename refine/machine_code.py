"""Machine code of native kernels: compiled by numba once, loaded without it ever after.

It is kept in a file for each kernel and each list of types of arguments, and read by llvmlite
alone, the library that numba stands on. It holds for the processor and for the source it was made
from, the files of other kernels that it calls included, and is made anew when one of them changes.

Two things differ from what numba would make. All optimisation is done in one go: numba's own ends
with loops unrolled while the code for errors is still in them, though none can happen here. And
neighbouring operations are done at once (LLVM's SLP vectoriser, which numba leaves off): it is why
rows of four numbers are quick. Neither changes a result to the last bit.
"""

import ctypes
import functools
import hashlib
import os
import tempfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from .kernels import OPTIONS, Compiled, say_compiling
from .lanes import Instruction

NUMBA_ONLY = ("numba_", "NRT_", "Py")
"""Names of what is not there without numba: its memory, its errors, and Python."""
HEAD = 64
"""Bytes of a file before the code: what it is valid for, and a check sum."""


@functools.cache
def load(kernel: Compiled[Any, Any], types: str) -> Callable[[int], int]:
    """Return a kernel as a function of the address of its list of arguments (native.py).

    `types`: "int" or, say, "float32[: 3]" for every argument; a colon is a length that is not part
    of the code.
    """
    name = f"{kernel.py_func.__module__}.{kernel.py_func.__name__}"
    symbol = f"{name}.{hashlib.sha256(types.encode()).hexdigest()[:12]}"
    return _function(symbol, f"{types} {_sources(kernel)}", lambda: _compile(kernel, types, symbol))


@functools.cache
def load_turns() -> Callable[[int], int]:
    """Return a function that runs others in turn, until one returns something else than 0.

    It takes the address of a list: for each the addresses of the function and of its own list, and
    0 at the end; it returns what the last one that ran did.
    """
    symbol = f"{__name__}.turns"
    return _function(symbol, _digest(__file__), lambda: _compile_turns(symbol))


def _function(symbol: str, made_of: str, compiled: Callable[[], bytes]) -> Callable[[int], int]:
    """The function of this name, from its file if that is still valid, else from `compiled`."""
    made_for = f"{_processor()} {_llvm().llvm_version_info} {made_of}"
    valid_for = hashlib.sha256(made_for.encode()).digest()
    code = _read(symbol, valid_for)
    if code is None:
        say_compiling()
        code = compiled()
        _keep(symbol, valid_for, code)
    engine = _engine()
    engine.add_object_file(_llvm().object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    signature = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)
    return signature(engine.get_function_address(symbol))


def _sources(kernel: Compiled[Any, Any]) -> str:
    """Digests of the files that a kernel is made from: its own, those of what it calls, ours."""
    files = {__file__}
    waiting = [kernel.py_func]
    while waiting:
        function = waiting.pop()
        files.add(function.__code__.co_filename)
        for name in function.__code__.co_names:
            used = function.__globals__.get(name)
            if isinstance(used, Compiled) and used.py_func is not function:
                waiting.append(used.py_func)
            elif isinstance(used, Instruction):
                files.add(used.file)
    return " ".join(_digest(file) for file in sorted(files))


@functools.cache
def _digest(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


@functools.cache
def _folder() -> Path:
    """Where machine code is kept: where numba keeps its own, or for the user if that is closed."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    here = Path(chosen) if chosen else Path(__file__).parent / "__pycache__"
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / __name__
    for folder in (here, home):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return Path(tempfile.mkdtemp())  # for this process only: others could write to a known place


def _read(symbol: str, valid_for: bytes) -> bytes | None:
    """Return the machine code of a file; None if there is none, or for something else, or torn."""
    try:
        content = (_folder() / f"{symbol}.o").read_bytes()
    except OSError:
        return None
    code = content[HEAD:]
    return code if content[:HEAD] == valid_for + hashlib.sha256(code).digest() else None


def _keep(symbol: str, valid_for: bytes, code: bytes) -> None:
    """Write machine code to its file; other processes see the whole of it or nothing."""
    try:
        with tempfile.NamedTemporaryFile(dir=_folder(), delete=False) as file:
            file.write(valid_for + hashlib.sha256(code).digest() + code)
        os.replace(file.name, _folder() / f"{symbol}.o")
    except OSError:
        return  # a full disk: it is compiled again next time


@functools.cache
def _llvm() -> Any:
    llvm: Any = import_module("llvmlite.binding")
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm


@functools.cache
def _processor() -> tuple[str, str, str]:
    """Kind of computer, processor, and what it can do, in LLVM's words."""
    llvm = _llvm()
    features = llvm.get_host_cpu_features().flatten()
    return llvm.get_default_triple(), llvm.get_host_cpu_name(), features


def _machine() -> Any:
    """LLVM's idea of the processor; a new one each time, because an engine takes it over."""
    triple, name, features = _processor()
    target = _llvm().Target.from_triple(triple)
    return target.create_target_machine(
        cpu=name,
        features=features,
        opt=3,
        reloc="static" if target.name.startswith("x86") else "default",  # as numba has it
        codemodel="jitdefault",
        jit=True,
    )


@functools.cache
def _engine() -> Any:
    """What puts machine code into memory; it lives as long as the process."""
    return _llvm().create_mcjit_compiler(_llvm().parse_assembly(""), _machine())


def _compile(kernel: Compiled[Any, Any], types: str, symbol: str) -> bytes:
    """Machine code of a kernel behind a function `symbol` that takes the address of its list."""
    llvm, machine = _llvm(), _machine()
    entry = _entry(kernel, types)
    module = llvm.parse_assembly(entry.inspect_llvm())
    for function in module.functions:
        if function.name == entry.native_name:
            function.name = symbol
        elif not function.is_declaration:
            function.linkage = "internal"
    # First what numba adds for errors that cannot happen goes away, then the loops are looked at.
    for level in (1, 3):
        options = llvm.create_pipeline_tuning_options(speed_level=level)
        options.loop_vectorization = options.slp_vectorization = level == 3
        options.loop_unrolling = level == 3
        passes = llvm.create_pass_builder(machine, options)
        passes.getModulePassManager().run(module, passes)
    for function in module.functions:
        assert not (function.is_declaration and function.name.startswith(NUMBA_ONLY)), (
            f"{symbol} allocates or raises: it calls {function.name}"
        )
    return bytes(machine.emit_object(module))


def _compile_turns(symbol: str) -> bytes:
    """Machine code of `load_turns`, written for LLVM by hand: numba has no calls of addresses."""
    ir: Any = import_module("llvmlite.ir")
    number = ir.IntType(64)
    signature = ir.FunctionType(number, [number])
    run = ir.Function(ir.Module(), signature, symbol)
    first, test, turn, done = (run.append_basic_block() for _ in range(4))
    ir.IRBuilder(first).branch(test)
    code = ir.IRBuilder(test)
    at, last = code.phi(number), code.phi(number)
    function = code.load(code.inttoptr(at, number.as_pointer()))
    is_over = code.or_(
        code.icmp_unsigned("==", function, number(0)), code.icmp_unsigned("!=", last, number(0))
    )
    code.cbranch(is_over, done, turn)
    code = ir.IRBuilder(turn)
    own_list = code.load(code.inttoptr(code.add(at, number(8)), number.as_pointer()))
    result = code.call(code.inttoptr(function, signature.as_pointer()), [own_list])
    for value, before, after in (
        (at, run.args[0], code.add(at, number(16))),
        (last, number(0), result),
    ):
        value.add_incoming(before, first)
        value.add_incoming(after, turn)
    code.branch(test)
    ir.IRBuilder(done).ret(last)
    return bytes(_machine().emit_object(_llvm().parse_assembly(str(run.module))))


def _entry(kernel: Compiled[Any, Any], types: str) -> Any:
    """Let numba compile a C function that takes the list apart and calls the kernel."""
    numba: Any = import_module("numba")
    config: Any = import_module("numba.core.config")
    lock = import_module("numba.core.compiler_lock").global_compiler_lock
    names = {
        "carray": numba.carray,
        "numpy": import_module("numpy"),
        "pointer": _pointer(),
        "kernel": kernel,
    }
    exec(_entry_source(types, kernel.py_func.__annotations__.get("return")), names)
    signature = numba.types.int64(numba.types.CPointer(numba.types.int64))
    # What compiles for everybody is set up before options change that are not for everybody.
    assert import_module("numba.core.registry").cpu_target.target_context
    with lock:
        before = config.OPT, config.LOOP_VECTORIZE
        config.OPT, config.LOOP_VECTORIZE = 0, 0  # left to _compile
        try:
            return numba.cfunc(signature, error_model=OPTIONS["error_model"])(names["entry"])
        finally:
            config.OPT, config.LOOP_VECTORIZE = before


def _entry_source(types: str, returns: object) -> str:
    """Python of a function that takes the list apart: addresses with their lengths, and numbers."""
    arguments, place = [], 0
    for kind in types.split(", "):
        dtype, _, lengths = kind.rstrip("]").partition("[")
        if not lengths:
            arguments.append(f"at[{place}]")
            place += 1
            continue
        shape = [
            f"at[{place + 1 + i}]" if length == ":" else length
            for i, length in enumerate(lengths.split())
        ]
        dtype = "bool_" if dtype == "bool" else dtype
        arguments.append(f"carray(pointer(at[{place}]), ({', '.join(shape)},), numpy.{dtype})")
        place += 1 + len(shape)
    result = "result" if returns not in (None, "None") else "0"
    return "\n    ".join(
        [
            "def entry(list):",
            f"at = carray(list, ({place},))",
            f"result = kernel({', '.join(arguments)})",
            f"return {result}",
        ]
    )


def _pointer() -> Any:
    """A function for compiled code that turns an address into a pointer."""
    types: Any = import_module("numba").types

    def pointer(context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

        return types.voidptr(address), generate

    return import_module("numba.extending").intrinsic(pointer)
