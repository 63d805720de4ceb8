"""Compiling each kernel once: what is called is linked in before it is optimised, not after.

numba optimises every function together with all that it calls and makes machine code of it, and
does the same again for whoever calls it: a kernel five calls deep five times. Here a function that
only compiled code calls ends as LLVM's own language. Its entry links all of them and makes
machine code once. Nobody else can call them there, so LLVM may leave out what they do not read: a
tuple of arrays comes as some hundred numbers, which each call would otherwise write down.

This leans on how numba is made inside, as `files.py` does; its version is pinned for that.
"""

# mypy: disable-error-code="arg-type, attr-defined, call-arg, no-untyped-call"
# (numba says types of some of its inside, and not these)

from __future__ import annotations

from typing import Any, ClassVar

from llvmlite import binding as llvm
from numba import _dynfunc, types
from numba.core import event, ir
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, CompileResult, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.environment import lookup_environment
from numba.core.ir_utils import find_const, get_definition, guard
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import AnnotateTypes, NativeLowering
from numba.core.typing import signature

from teamformer.base.kernels.announcing import ANNOUNCER
from teamformer.base.kernels.clock import begin_compiling, end_compiling
from teamformer.base.kernels.files import KernelFiles

ENVIRONMENT = "_ZN08NumbaEnv"
"""How the name of a global begins that holds what a function needs of the interpreter."""


class _InnerLibrary(JITCodeLibrary):
    """The code of a function that only compiled code calls, with that of all that it calls.

    It is neither optimised nor made machine code of: that is done where it is linked in.
    """

    def finalize(self) -> None:
        """Link what is called; nothing can be added after."""
        self._raise_if_finalized()
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """Return what is kept on disk; there is no object code."""
        return self.name, "bitcode", self._get_module_for_linking().as_bitcode()

    @classmethod
    def _unserialize(cls, codegen: Any, state: tuple[str, str, bytes]) -> _InnerLibrary:
        name, _, bitcode = state
        library = cls(codegen, name)
        library._final_module = llvm.parse_bitcode(bitcode)
        library._finalize_dynamic_globals()
        library._finalized = True
        return library


class _EntryLibrary(JITCodeLibrary):
    """The code of a function that Python calls, with that of all that it calls.

    What it calls is its own: LLVM takes functions that are called once apart, and leaves out
    arguments that nobody reads. A round of the search for plans takes 10 to 35% less time so.
    """

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if function.linkage is llvm.Linkage.linkonce_odr and not function.is_declaration:
                function.linkage = llvm.Linkage.internal
        super()._optimize_final_module()


@register_pass(mutates_CFG=False, analysis_only=False)
class _CountFromFirst(LoweringPass):
    """Let indices be whole numbers without a sign: none counts from the end of an array.

    Nobody asks at each access whether an index is negative then: a search makes a third more
    rounds in the same time. Only a number in the code, as -1, and an index beside a slice may still
    count from the end. Where every index is checked, any other that is negative is an error.
    """

    _name = "teamformer_count_from_first"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        for block in state.func_ir.blocks.values():
            for access in [*block.find_exprs("getitem"), *block.find_insts(ir.SetItem)]:
                kind = state.calltypes[access]
                array, index, *value = kind.args
                if isinstance(array, types.Array) and not _has_minus(state.func_ir, access.index):
                    index = _without_sign(index)
                    del state.calltypes[access]  # which takes each once only
                    state.calltypes[access] = signature(kind.return_type, array, index, *value)
        return True


def _has_minus(code: Any, index: Any) -> bool:
    """Say whether an index, or one of several, is a negative number in the code."""
    meant = guard(get_definition, code, index)
    parts = meant.items if getattr(meant, "op", None) == "build_tuple" else [index]
    numbers = (guard(find_const, code, part) for part in parts)
    return any(isinstance(number, int) and number < 0 for number in numbers)


def _without_sign(index: Any) -> Any:
    """Return the type of an index, or of several, without a sign; slices stay as they are."""
    if isinstance(index, types.Integer):
        return types.uintp
    if isinstance(index, types.BaseTuple) and all(isinstance(i, types.Integer) for i in index):
        return types.UniTuple(types.uintp, len(index))
    return index


@register_pass(mutates_CFG=True, analysis_only=False)
class _TellCallers(LoweringPass):
    """Make a function that was lowered known to those that call it."""

    _name = "teamformer_tell_callers"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        lowered = state["cr"]
        token = _token_of(lowered.fndesc, lowered.env, state.library)
        state.library.finalize()
        state.targetctx.insert_user_function(token, lowered.fndesc, [state.library])
        state["cr"] = lowered._replace(cfunc=token)
        return True


@register_pass(mutates_CFG=False, analysis_only=True)
class _BindEnvironments(LoweringPass):
    """Give inner functions their environments, which are known once there is machine code."""

    _name = "teamformer_bind_environments"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        for variable in state.library._final_module.global_variables:
            if variable.name.startswith(ENVIRONMENT):
                environment = lookup_environment(variable.name)
                if environment is not None:
                    state.library.codegen.set_env(variable.name, environment)
        return False


class _InnerCompiler(CompilerBase):
    """Compiles a function that only compiled code calls."""

    def compile_extra(self, func: Any) -> Any:
        """Lower a function and stop there."""
        self.state.library = _InnerLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.flags.no_compile = True
        return super().compile_extra(func)

    def define_pipelines(self) -> list[Any]:
        """Return numba's passes and ours."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_CountFromFirst, AnnotateTypes)
        passes.add_pass_after(_TellCallers, NativeLowering)
        passes.finalize()
        return [passes]


class _EntryCompiler(CompilerBase):
    """Compiles a function that Python calls."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function, with code of its own of all that it calls."""
        self.state.library = _EntryLibrary(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(func)

    def define_pipelines(self) -> list[Any]:
        """Return numba's passes and ours."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_CountFromFirst, AnnotateTypes)
        passes.add_pass_after(_BindEnvironments, NativeLowering)
        passes.finalize()
        return [passes]


class _Anywhere(_CacheLocator):
    """Tells numba nothing of where code is kept, as `KernelFiles` knows."""

    @classmethod
    def from_function(cls, py_func: Any, py_file: Any) -> _Anywhere:
        return cls()

    def ensure_cache_path(self) -> None:
        pass

    def get_cache_path(self) -> str:
        return ""

    def get_source_stamp(self) -> None:
        return None

    def get_disambiguator(self) -> str:
        return ""


class _EntryFiles(CompileResultCacheImpl):
    """Reads and writes what is kept of functions that Python calls."""

    _locator_classes: ClassVar = [_Anywhere]  # type: ignore[misc, list-item]


class _InnerFiles(_EntryFiles):
    """Reads and writes what is kept of inner functions."""

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> CompileResult:
        kept, fndesc, environment, signature, _, lifted, annotation, reload_init, others = payload
        for function in reload_init:
            function()
        library = _InnerLibrary._unserialize(target_context.codegen(), kept)
        return CompileResult(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=_token_of(fndesc, environment, library),
            typing_error=None,
            type_annotation=annotation,
            signature=signature,
            library=library,
            objectmode=False,
            lifted=lifted,
            fndesc=fndesc,
            call_helper=None,
            environment=environment,
            metadata=None,
            reload_init=reload_init,
            referenced_envs=others,
        )


class _EntryCache(FunctionCache):
    """What is kept of functions that Python calls."""

    _impl_class = _EntryFiles

    def __init__(self, function: Any, files: KernelFiles) -> None:
        super().__init__(function)
        self._cache_file: Any = files


class _InnerCache(_EntryCache):
    """What is kept of inner functions: LLVM's language, no machine code."""

    _impl_class = _InnerFiles


class _Kernel(CPUDispatcher):
    """A function that is compiled by one process at a time."""

    @property
    def files(self) -> KernelFiles | None:
        """Return where its code is kept; a copy of it that was sent to a process has none."""
        return getattr(self._cache, "_cache_file", None)

    def compile(self, sig: Any) -> Any:
        """Compile for types, or take what is kept, and let processes go on that wait for it."""
        try:
            return super().compile(sig)
        finally:
            if self.files is not None:
                self.files.end_turn()


class Inner(_Kernel):
    """A function that only compiled code calls."""

    pipeline, cache, prefix = _InnerCompiler, _InnerCache, "inner."

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for whole numbers of 64 bits only, whatever a caller has: once, not thrice."""
        wide = [_widen(kind) for kind in args]
        return super().get_call_template(wide, {name: _widen(kws[name]) for name in kws})


class Entry(_Kernel):
    """A function that Python calls; compiled code that calls it takes `inner`, which is the same.

    So nothing is made machine code of only to be linked into something else.
    """

    pipeline, cache, prefix = _EntryCompiler, _EntryCache, ""
    inner: Inner

    @property
    def _numba_type_(self) -> types.Dispatcher:
        return types.Dispatcher(self.inner)


def _token_of(fndesc: Any, environment: Any, library: _InnerLibrary) -> Any:
    """Return what numba knows a compiled function by; it cannot be called."""
    name = fndesc.qualname.split(".")[-1]
    told = f"{fndesc.qualname}, for compiled code only"
    return _dynfunc.make_function(
        fndesc.lookup_module(), name, told, 0, environment, (library, environment)
    )


def _widen(kind: Any) -> Any:
    kind = types.unliteral(kind)
    is_short = isinstance(kind, types.Integer) and kind.signed and kind.bitwidth < 64
    return types.int64 if is_short else kind


class _CompileListener(event.Listener):
    """Has the clock stand still while numba compiles, and says what it compiles of ours."""

    def on_start(self, event: Any) -> None:
        """Note when compiling begins; numba holds a lock while it compiles."""
        function = event.data["dispatcher"]
        if begin_compiling() and isinstance(function, _Kernel):
            is_kept = function.files is not None and function.files.home is not None
            ANNOUNCER.begin(function.py_func.__module__, is_kept)

    def on_end(self, event: Any) -> None:
        """Note when it ends."""
        end_compiling()
        ANNOUNCER.end()


event.register("numba:compile", _CompileListener())
