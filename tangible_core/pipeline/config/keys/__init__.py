"""The kinds of keys that a pipeline file may have: how each is read, written and described."""

from .block import NULL_IS_DEFAULT as NULL_IS_DEFAULT
from .block import Block as Block
from .block import Word as Word
from .key import Key as Key
from .key import Reading as Reading
from .key import Unchecked as Unchecked
from .kinds import MethodBlock as MethodBlock
from .kinds import MethodList as MethodList
from .kinds import PartsBlock as PartsBlock
from .kinds import SceneBlock as SceneBlock
