"""A unit of FMI 3.0 as a component for WebAssembly (draft FMI-LS-WASM), stepped by wasmtime."""

import zipfile
from functools import cache

from wasmtime import Config, Engine, Store, WasiConfig
from wasmtime.component import Component, Linker

PACKAGE = "fmi:fmi3/{}@3.0.0"
RESOURCE = "co-simulation-instance"


ENGINE = Engine(Config())


@cache
def compiled(binary):
    """A component as machine code, which takes a second."""
    return Component(ENGINE, binary)


class Unit:
    """The co-simulation instance of an archive; methods are those of the draft, `do_step` for `do-step`."""

    def __init__(self, archive, token, resources=None):
        with zipfile.ZipFile(archive) as file:
            names = file.namelist()
            files = {
                name.removeprefix("resources/"): file.read(name)
                for name in names
                if name.startswith("resources/")
            }
            (binary,) = (name for name in names if name.startswith("binaries/wasm32-wasip2/"))
            binary = file.read(binary)
        files = files if resources is None else resources
        self.log = []

        def read_file(_, path):
            return files.get(path, f"there is no {path}")

        def log_message(_, *message):
            self.log.append(message)

        self.store = Store(ENGINE)
        self.store.set_wasi(WasiConfig())
        linker = Linker(ENGINE)
        linker.add_wasip2()
        with linker.root() as root:
            with root.add_instance(PACKAGE.format("callbacks")) as callbacks:
                callbacks.add_func("log-message", log_message)
            with root.add_instance(PACKAGE.format("resource-dir-callbacks")) as callbacks:
                callbacks.add_func("read-file", read_file)
        self.module = linker.instantiate(self.store, compiled(binary))
        self.functions = {}
        self.version = self._function("common", "get-version")(self.store)
        make = self._function("co-simulation", f"[static]{RESOURCE}.instantiate-co-simulation")
        self.handle = make(self.store, "unit", token, False, True, False, False, [])

    def _function(self, interface, name):
        at = self.module.get_export_index(self.store, PACKAGE.format(interface))
        at = self.module.get_export_index(self.store, name, at)
        return self.module.get_func(self.store, at)

    def __getattr__(self, name):
        if name not in self.functions:
            method = f"[method]{RESOURCE}.{name.replace('_', '-')}"
            self.functions[name] = self._function("co-simulation", method)
        function = self.functions[name]

        def call(*arguments):
            answer = function(self.store, self.handle, *arguments)
            function.post_return(self.store)
            return answer

        return call

    def free(self):
        self.handle.drop(self.store)
