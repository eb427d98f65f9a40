!> Paths that a window meshes with fewer vertices: the removed vertices, and preserved arc lengths.
program test_twolevel_window_path
   use base_kinds, only: ik, rk
   use mesh_builder, only: mesh_spec_t
   use mesh_types, only: fracture_mesh_t, network_t
   use testing_checks, only: checks_t
   use twolevel_window_path, only: restore_fractures, straighten_far
   implicit none(type, external)

   integer(ik), parameter :: n = 41  !< vertices of the path, 5 mm apart
   real(rk), parameter :: step = 0.005_rk  !< [m]
   type(checks_t) :: checks
   type(mesh_spec_t) :: spec

   ! A window from 0 to 0.5 m with the tip in its middle, and elements of 5 to 20 mm at fractures.
   spec%x_min = 0.0_rk
   spec%x_max = 0.5_rk
   spec%y_min = 0.0_rk
   spec%y_max = 0.5_rk
   spec%size_fracture = step
   spec%focus_slope = 0.4_rk
   spec%focus_size = 4.0_rk*step
   spec%foci = reshape([0.25_rk, 0.25_rk], [2, 1])
   call test_far_vertices()
   call test_bends()
   call test_other_fractures()
   call test_loop()
   call test_edge()
   call test_arc_lengths()
   call test_left_out()
   call checks%finish()

contains

   !> A path to the tip from the right, lifted by `height` at each second vertex.
   pure type(network_t) function path(height) result(network)
      real(rk), intent(in) :: height  !< [m]
      integer(ik) :: i

      network%first = [1_ik, n + 1_ik]
      network%s_start = [0.1_rk]
  network%xy = reshape([(0.25_rk + step*(n - i), 0.25_rk + height*mod(i, 2_ik), i=1, n)], [2_ik, n])
   end function path

   !> Vertices are removed where the elements are larger than their distance, and only there.
   subroutine test_far_vertices()
      type(network_t) :: simple
      integer(ik), allocatable :: kept(:)
      real(rk) :: longest
      integer(ik) :: i

      call straighten_far(path(0.0_rk), spec, .true., [.true.], simple, kept)
      call checks%is_true(kept(1) == 1 .and. kept(size(kept)) == n, "path: its ends stay")
      call checks%is_true(2*size(kept) < n, "path: many vertices go")
     call checks%is_true(all(simple%first == [1, size(kept) + 1]), "path: all vertices are counted")
      longest = 0.0_rk
      do i = 2, size(kept, kind=ik)
         longest = max(longest, step*(kept(i) - kept(i - 1)))
         if (n - kept(i) > 2) cycle
         call checks%is_true(kept(i) == kept(i - 1) + 1, "path: nothing goes at the tip")
      end do
      call checks%is_true(longest <= spec%focus_size*(1.0_rk + 1.0e-12_rk), &
                          "path: no line is longer than elements there")
      call checks%is_true(longest >= 3.0_rk*step, "path: lines far away are long")
   end subroutine test_far_vertices

   !> Vertices that deviate from the line by more than 0.5 % of the elements stay.
   subroutine test_bends()
      type(network_t) :: simple
      integer(ik), allocatable :: kept(:)

      call straighten_far(path(0.006_rk*spec%focus_size), spec, .true., [.true.], simple, kept)
      call checks%is_true(size(kept) == n, "bends: all stay")
      call straighten_far(path(0.001_rk*step), spec, .true., [.true.], simple, kept)
      call checks%is_true(size(kept) < n, "bends: slight ones go")
   end subroutine test_bends

   !> Where another fracture ends on the path or crosses it, the path stays unchanged.
   subroutine test_other_fractures()
      type(network_t) :: network, simple
      integer(ik), allocatable :: kept(:)
      real(rk) :: x
      integer(ik) :: k

      x = 0.25_rk + step*(n - 6) - 0.3_rk*step  ! between vertices 6 and 7
      do k = 1, 2
         network = path(0.0_rk)
         network%first = [1_ik, n + 1_ik, n + 3_ik]
         network%s_start = [0.1_rk, 0.0_rk]
         network%xy = reshape([network%xy, x, merge(0.25_rk, 0.2_rk, k == 1), x, 0.3_rk], &
                              [2_ik, n + 2_ik])
         call straighten_far(network, spec, .true., all_of(network), simple, kept)
         call checks%is_true(all([any(kept == 6), any(kept == 7)]), "joint: its segment stays")
         call checks%is_true(all(kept(size(kept) - 1:) == [n + 1, n + 2]), "joint: the other stays")
         call checks%is_true(size(kept) < n, "joint: elsewhere vertices go")
      end do
   end subroutine test_other_fractures

   !> A path that returns to itself: it stays unchanged where its end meets it.
   subroutine test_loop()
      type(network_t) :: network, simple
      integer(ik), allocatable :: kept(:)
      real(rk) :: x

      x = 0.25_rk + step*(n - 6) - 0.3_rk*step  ! between vertices 6 and 7
      network = path(0.0_rk)
      network%first = [1_ik, n + 4_ik]
      network%xy = reshape([x, 0.25_rk, x, 0.4_rk, network%xy(1, 1), 0.4_rk, network%xy], &
                           [2_ik, n + 3_ik])
      call straighten_far(network, spec, .true., all_of(network), simple, kept)
      call checks%is_true(all([any(kept == 9), any(kept == 10)]), "loop: its segment stays")
      call checks%is_true(size(kept) < n, "loop: elsewhere vertices go")
   end subroutine test_loop

   !> Where the path leaves the window it stays unchanged: displacements there differ between the
   !! sides.
   subroutine test_edge()
      type(network_t) :: network, simple
      integer(ik), allocatable :: kept(:)
      integer(ik) :: i

      network = path(0.0_rk)
      spec%x_max = 0.25_rk + step*(n - 6) - 0.3_rk*step
      call straighten_far(network, spec, .false., all_of(network), simple, kept)
      call checks%is_true(all([any(kept == 6), any(kept == 7)]), "edge: what crosses it stays")
      call checks%is_true(any([(.not. any(kept == i), i=1, 5)]), "edge: outside vertices go")
      spec%x_max = 0.5_rk
   end subroutine test_edge

   !> Fracture cells of the simplified path have the arc lengths of the whole path: exactly at
   !! vertices, and in proportion between them.
   subroutine test_arc_lengths()
      type(network_t) :: network, simple
      type(fracture_mesh_t) :: fractures
      integer(ik), allocatable :: kept(:)
      real(rk) :: lengths(n), simple_s
      integer(ik) :: i

      network = path(0.002_rk*spec%focus_size)
      lengths(1) = 0.1_rk
      do i = 2, n
         lengths(i) = lengths(i - 1) + norm2(network%xy(:, i) - network%xy(:, i - 1))
      end do
      call straighten_far(network, spec, .true., all_of(network), simple, kept)
      call checks%is_true(size(kept) < n, "arc lengths: vertices go")
      ! Two cells between each two vertices.
      fractures%n_cells = 2*(size(kept, kind=ik) - 1)
      allocate (fractures%cell_fracture(fractures%n_cells), source=1_ik)
      allocate (fractures%tip_fracture(0))
      allocate (fractures%cell_s(2, fractures%n_cells))
      simple_s = 0.1_rk
      do i = 1, size(kept, kind=ik) - 1
         associate (length => norm2(simple%xy(:, i + 1) - simple%xy(:, i)))
            fractures%cell_s(:, 2*i - 1) = simple_s + [0.0_rk, 0.3_rk]*length
            fractures%cell_s(:, 2*i) = simple_s + [0.3_rk, 1.0_rk]*length
            simple_s = simple_s + length
         end associate
      end do
      call restore_fractures(network, simple, kept, fractures)
      do i = 1, size(kept, kind=ik) - 1
         associate (whole => lengths(kept(i:i + 1)), s => fractures%cell_s(:, 2*i - 1:2*i))
            call checks%is_close(s(1, 1), whole(1), 1.0e-14_rk, "arc lengths: start")
            call checks%is_close(s(2, 2), whole(2), 1.0e-14_rk, "arc lengths: end")
            call checks%is_close(s(2, 1), whole(1) + 0.3_rk*(whole(2) - whole(1)), 1.0e-14_rk, &
                                 "arc lengths: between")
            call checks%is_close(s(1, 2), s(2, 1), 1.0e-14_rk, "arc lengths: cells touch")
         end associate
      end do
   end subroutine test_arc_lengths

   !> Of three fractures the second one is left out; the third keeps its number and arc lengths.
   subroutine test_left_out()
      type(network_t) :: network, simple
      type(fracture_mesh_t) :: fractures
      integer(ik), allocatable :: kept(:)

      network = network_t(first=[1_ik, 3_ik, 6_ik, 8_ik], s_start=[0.1_rk, 0.2_rk, 0.3_rk], &
                          xy=reshape([0.1_rk, 0.1_rk, 0.2_rk, 0.1_rk, 0.1_rk, 0.4_rk, 0.2_rk, &
                                      0.4_rk, 0.2_rk, 0.45_rk, 0.3_rk, 0.1_rk, 0.4_rk, 0.1_rk], &
                                     [2, 7]))
      call straighten_far(network, spec, .true., [.true., .false., .true.], simple, kept)
      call checks%is_true(all(kept == [1, 2, 6, 7]) .and. all(simple%first == [1, 3, 5]), &
                          "left out: vertices")
      fractures%n_cells = 2
      fractures%cell_fracture = [1_ik, 2_ik]
      fractures%tip_fracture = [1_ik, 2_ik, 2_ik]
      fractures%cell_s = reshape([0.1_rk, 0.2_rk, 0.3_rk, 0.4_rk], [2, 2])
      call restore_fractures(network, simple, kept, fractures)
      call checks%is_true(all(fractures%cell_fracture == [1, 3]) .and. &
                          all(fractures%tip_fracture == [1, 3, 3]), "left out: numbers")
      call checks%is_close(fractures%cell_s(2, 2), 0.4_rk, 1.0e-14_rk, "left out: arc length")
   end subroutine test_left_out

   !> All fractures are in the mesh.
   pure function all_of(network) result(is_needed)
      type(network_t), intent(in) :: network
      logical :: is_needed(size(network%first) - 1)

      is_needed = .true.
   end function all_of

end program test_twolevel_window_path
