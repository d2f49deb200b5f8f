"""The tables, in the order of the document."""

from benchmarks.reproduce.rows import Table
from benchmarks.reproduce.tables.biped import BIPED
from benchmarks.reproduce.tables.block import BLOCK_FORCE, BLOCK_WORK
from benchmarks.reproduce.tables.cart_pole import CART_POLE, CART_POLE_DERIVATIVES
from benchmarks.reproduce.tables.contact import CONTACT
from benchmarks.reproduce.tables.pendulum import PENDULUM
from benchmarks.reproduce.tables.quadrotor import QUADROTOR
from benchmarks.reproduce.tables.slip import SLIP

TABLES: tuple[Table, ...] = (
    BLOCK_FORCE,
    CART_POLE,
    BIPED,
    BLOCK_WORK,
    QUADROTOR,
    PENDULUM,
    CART_POLE_DERIVATIVES,
    SLIP,
    CONTACT,
)
