"""What the names of lanes.py stand for, in LLVM's words; imported when a kernel is compiled.

Every instruction here is one of a few that every processor with vectors has; LLVM finds the right
ones, and takes several where a processor has none that is so wide.
"""

import operator
from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.registry import cpu_target
from numba.extending import intrinsic, overload, register_model

INDEX = ir.IntType(32)
WIDE = ir.IntType(64)
CYCLED = (1, 2, 0, 3)
"""y z x: a cross product is made of p x cycled q - cycled p x q."""


class Lanes(types.Type):
    """`count` numbers of one type, side by side."""

    def __init__(self, number: Any, count: int = 4) -> None:
        self.number, self.count = number, count
        super().__init__(name=f"{count} x {number}")


@register_model(Lanes)
class LanesModel(models.PrimitiveModel):
    """In LLVM, a vector."""

    def __init__(self, models: Any, lanes: Lanes) -> None:
        number = models.lookup(lanes.number).get_value_type()
        super().__init__(models, lanes, ir.VectorType(number, lanes.count))


def type_of(name: str) -> Any:
    """Numba's type of one of the functions below."""
    context = cpu_target.typing_context
    context.refresh()  # or it has not heard of this file yet
    return context.resolve_value_type(globals()[name])


def _place(context: Any, builder: Any, rows_type: Any, rows: Any, k_type: Any, k: Any) -> Any:
    """The address of row k, or of number k."""
    array = context.make_array(rows_type)(context, builder, rows)
    if k.type.width < WIDE.width:
        k = builder.sext(k, WIDE) if k_type.signed else builder.zext(k, WIDE)
    shape, strides = (
        cgutils.unpack_tuple(builder, part, rows_type.ndim) for part in (array.shape, array.strides)
    )
    indices = [k, *[WIDE(0)] * (rows_type.ndim - 1)]
    return cgutils.get_item_pointer2(
        context, builder, array.data, shape, strides, "C", indices, wraparound=False
    )


def _taken(rows: Any, k: Any, count: int) -> Any:
    lanes = Lanes(rows.dtype, count)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        (rows_type, k_type), vector = signature.args, context.get_value_type(lanes)
        place = _place(context, builder, rows_type, arguments[0], k_type, arguments[1])
        place = builder.bitcast(place, vector.as_pointer())
        return builder.load(place, align=rows_type.dtype.bitwidth // 8)

    return lanes(rows, k), generate


@intrinsic
def four(context: Any, rows: Any, k: Any) -> Any:
    """See lanes.py."""
    return _taken(rows, k, 4)


@intrinsic
def twelve(context: Any, rows: Any, k: Any) -> Any:
    """See lanes.py."""
    return _taken(rows, k, 12)


@intrinsic
def write(context: Any, rows: Any, k: Any, numbers: Any) -> Any:
    """See lanes.py."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        rows_type, k_type, _ = signature.args
        place = _place(context, builder, rows_type, arguments[0], k_type, arguments[1])
        place = builder.bitcast(place, arguments[2].type.as_pointer())
        builder.store(arguments[2], place, align=rows_type.dtype.bitwidth // 8)
        return context.get_dummy_value()

    return types.void(rows, k, numbers), generate


@intrinsic
def is_zero(context: Any, numbers: Any) -> Any:
    """See lanes.py."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        bits = ir.IntType(numbers.count * numbers.number.bitwidth)
        return builder.icmp_unsigned("==", builder.bitcast(arguments[0], bits), bits(0))

    return types.boolean(numbers), generate


@intrinsic
def counted_from(context: Any, k: Any) -> Any:
    """See lanes.py."""
    lanes = Lanes(types.uint32)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        (first,) = arguments
        if first.type.width > INDEX.width:
            first = builder.trunc(first, INDEX)
        vector = context.get_value_type(lanes)
        return builder.add(_spread(builder, first), ir.Constant(vector, [0, 1, 2, 3]))

    return lanes(k), generate


@intrinsic
def spread(context: Any, number: Any) -> Any:
    """See lanes.py."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _spread(builder, arguments[0])

    return Lanes(number)(number), generate


@intrinsic
def single(context: Any, numbers: Any) -> Any:
    """See lanes.py."""
    lanes = Lanes(types.float32, numbers.count)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fptrunc(arguments[0], context.get_value_type(lanes))

    return lanes(numbers), generate


@intrinsic
def cross(context: Any, p: Any, q: Any) -> Any:
    """See lanes.py."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        p, q = arguments
        p_cycled, q_cycled = _shuffled(builder, p, p, CYCLED), _shuffled(builder, q, q, CYCLED)
        product = builder.fsub(builder.fmul(p, q_cycled), builder.fmul(p_cycled, q))
        return _shuffled(builder, product, product, CYCLED)

    return p(p, q), generate


@intrinsic
def sums_of_three(context: Any, p: Any, q: Any, r: Any, s: Any) -> Any:
    """See lanes.py."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        p, q, r, s = arguments
        xy, xy_ = (_shuffled(builder, *pair, order=(0, 4, 1, 5)) for pair in ((p, q), (r, s)))
        zw, zw_ = (_shuffled(builder, *pair, order=(2, 6, 3, 7)) for pair in ((p, q), (r, s)))
        x, y = _shuffled(builder, xy, xy_, (0, 1, 4, 5)), _shuffled(builder, xy, xy_, (2, 3, 6, 7))
        z = _shuffled(builder, zw, zw_, (0, 1, 4, 5))
        return builder.fadd(builder.fadd(x, y), z)

    return p(p, q, r, s), generate


@intrinsic
def above(context: Any, p: Any, limits: Any) -> Any:
    """See lanes.py."""
    lanes = Lanes(types.uint8, p.count)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        is_above = builder.fcmp_ordered(">", *arguments)
        return builder.zext(is_above, context.get_value_type(lanes))

    return lanes(p, limits), generate


def _spread(builder: Any, number: Any) -> Any:
    first = builder.insert_element(
        ir.Constant(ir.VectorType(number.type, 4), ir.Undefined), number, INDEX(0)
    )
    return _shuffled(builder, first, first, (0, 0, 0, 0))


def _shuffled(builder: Any, p: Any, q: Any, order: Sequence[int]) -> Any:
    """Numbers of p, 0 to 3, and of q, 4 to 7, in another order."""
    return builder.shuffle_vector(p, q, ir.Constant(ir.VectorType(INDEX, len(order)), list(order)))


def _operation(of_floats: str, of_integers: str) -> Any:
    """An operation, number by number."""

    @intrinsic
    def apply(context: Any, p: Any, q: Any) -> Any:
        word = of_floats if isinstance(p.number, types.Float) else of_integers

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return getattr(builder, word)(*arguments)

        return p(p, q), generate

    return apply


_spread_out: Any = spread
_sum, _difference, _product = (
    _operation("fadd", "add"), _operation("fsub", "sub"), _operation("fmul", "mul")
)  # fmt: skip


@overload(operator.add, strict=False)
def _add(p: Any, q: Any) -> Callable[..., Any] | None:
    return (lambda p, q: _sum(p, q)) if isinstance(p, Lanes) and p == q else None


@overload(operator.sub, strict=False)
def _subtract(p: Any, q: Any) -> Callable[..., Any] | None:
    return (lambda p, q: _difference(p, q)) if isinstance(p, Lanes) and p == q else None


@overload(operator.mul, strict=False)
def _multiply(p: Any, q: Any) -> Callable[..., Any] | None:
    if isinstance(p, Lanes) and p == q:
        return lambda p, q: _product(p, q)
    if isinstance(q, Lanes) and p == q.number:
        return lambda p, q: _product(_spread_out(p), q)
    return None
