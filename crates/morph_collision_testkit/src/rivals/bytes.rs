/// The heap memory that a method needs, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodBytes {
    /// What all bodies of a mesh share.
    pub shared: usize,
    /// What a body has of its own.
    pub body: usize,
}

/// The heap memory of a list.
pub(super) fn of_list<T>(list: &Vec<T>) -> usize {
    list.capacity() * size_of::<T>()
}
